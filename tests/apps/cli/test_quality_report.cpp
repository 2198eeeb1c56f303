// What is said of a run's quality.
#include "apps/cli/run/quality/quality_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace eventide::app {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

TEST(QualityReport, AChangeIsToAHigherOrALowerLevel) {
    const QualityLevel best{1, 0, SensorDuration{2000}};
    for (const QualityLevel& lower :
         {QualityLevel{1, 0, SensorDuration{5000}}, QualityLevel{1, 1, SensorDuration{2000}},
          QualityLevel{.5, 0, SensorDuration{2000}}}) {
        EXPECT_THAT(change_text({{}, best, lower, {}}, 30), StartsWith("quality lowered from 1x"));
        EXPECT_THAT(change_text({{}, lower, best, {}}, 30), StartsWith("quality raised from"));
    }
    // The size decides, then the rate.
    EXPECT_THAT(change_text({{}, {1, 2, {}}, {.5, 0, {}}, {}}, 30), StartsWith("quality lowered"));
    EXPECT_THAT(
        change_text({{}, {1, 1, SensorDuration{2000}}, {1, 0, SensorDuration{9000}}, {}}, 30),
        StartsWith("quality raised"));
}

TEST(QualityReport, ALevelIsItsSizeItsRateAndItsWindows) {
    EXPECT_EQ(level_text({1, 1, SensorDuration{5000}}, 30),
              "1x 15 frames/s, event windows of 5 ms or more");
    EXPECT_EQ(level_text({1.0 / 3, 0, {}}, 30), "0.333x 30 frames/s");
    EXPECT_EQ(level_text({2, 0, SensorDuration{5000}}, 0), "2x a frame per event window");
    EXPECT_EQ(level_text({1, 0, {}}, 1000), "1x 1000 frames/s");
    EXPECT_EQ(level_text({1, 0, {}}, 1500), "1x 1500 frames/s");
}

TEST(QualityReport, ABudgetIsNamedWhereThereIsOne) {
    QualityState state;
    EXPECT_THAT(choice_text(state), Not(HasSubstr("--budget")));
    state.budget = "8ms";
    EXPECT_THAT(choice_text(state), HasSubstr("(--budget 8ms)"));
}

TEST(QualityReport, WhatThereIsNotIsNull) {
    QualityState state;
    state.chosen = true;
    EXPECT_TRUE(quality_json(state, true).at("min_window_ms").is_null());
    EXPECT_TRUE(quality_json(state, true).at("profile").is_null());
    state.level.min_window = SensorDuration{2000};
    state.profile = "some.json";
    EXPECT_EQ(quality_json(state, true).at("min_window_ms"), 2);
    EXPECT_EQ(quality_json(state, true).at("profile"), "some.json");
}

}  // namespace
}  // namespace eventide::app
