// The best quality that holds the pace is chosen, in the order that docs/usage.md tells.
#include "apps/cli/run/quality/quality_choice.h"
#include "apps/cli/settings/budget.h"
#include "src/core/error.h"

#include <gtest/gtest.h>

namespace eventide::app {
namespace {

/// f32 takes 10 ms for an event window, 2 more for its first frame, and 2 for a frame, of a third
/// of the size 0.4. bf16 takes half of all.
const std::vector<PrecisionCost> kCosts{{Precision::f32, "fast, AVX-512", 10, 2, 2, 2, 0.4},
                                        {Precision::bf16, "fast, bf16", 5, 1, 1, 1, 0.2}};
constexpr double third = 1.0 / 3;
const std::vector<PrecisionCost> kFloat{kCosts.front()};

QualityDemand usual(double frames = 30) {
    QualityDemand demand;
    demand.frames = frames;
    return demand;
}

TEST(QualityChoice, LoadIsThatOfWindowsFirstFramesAndOthers) {
    const NetworkLoad load = load_of(kCosts[0], {1, 0}, usual(30));
    EXPECT_DOUBLE_EQ(load.encode, 20 * 10e-3);
    EXPECT_DOUBLE_EQ(load.frames, 20 * 2e-3 + 30 * 2e-3);
    EXPECT_DOUBLE_EQ(load_of(kCosts[0], {1, 1}, usual(30)).frames, 15 * 4e-3)
        << "fewer than event windows: each is the first of its window";
    EXPECT_DOUBLE_EQ(load_of(kCosts[0], {1.0 / 3, 0}, usual(20)).frames, 20 * 2.4e-3);
    EXPECT_DOUBLE_EQ(load_of(kCosts[0], {0.5, 0}, usual(20)).frames, 20 * 4e-3)
        << "pixels between codes read four of them";
    EXPECT_DOUBLE_EQ(load_of(kCosts[0], {2, 0}, usual(20)).frames, 20 * 34e-3)
        << "larger ones by their area";
}

TEST(QualityChoice, TakesAllThatWasAskedForWhereItHolds) {
    const auto levels = quality_levels({1, 0}, true, true);
    const auto choice = best_that_holds(kCosts, levels, usual());
    ASSERT_TRUE(choice);
    EXPECT_EQ(choice->level, (QualityLevel{1, 0}));
    EXPECT_EQ(choice->precision, Precision::bf16) << "the quicker one";
    const std::vector<PrecisionCost> alike{kCosts[0],
                                           {Precision::bf16, "fast, bf16", 10, 2, 2, 2, 0.4}};
    EXPECT_EQ(best_that_holds(alike, levels, usual())->precision, Precision::f32);
}

TEST(QualityChoice, GivesUpTheRateFirstAndThenTheScale) {
    const auto levels = quality_levels({1, 0}, true, true);
    const std::vector<QualityLevel> order{{1, 0},     {1, 1},     {1, 2},
                                          {third, 0}, {third, 1}, {third, 2}};
    EXPECT_EQ(levels, order);
    QualityDemand demand = usual(200);  // f32: 0.2 for encoding; 0.44, 0.24, 0.14 for frames
    demand.share = 0.5;
    EXPECT_EQ(best_that_holds(kFloat, levels, demand)->level, (QualityLevel{1, 1}));
    demand.share = 0.35;
    EXPECT_EQ(best_that_holds(kFloat, levels, demand)->level, (QualityLevel{1, 2}));
    demand.share = 0.29;  // a third of the size: 0.12, 0.08, 0.06
    EXPECT_EQ(best_that_holds(kFloat, levels, demand)->level, (QualityLevel{third, 1}));
}

TEST(QualityChoice, GivesUpShortEventWindowsBeforeAllElse) {
    using namespace std::chrono_literals;
    EXPECT_EQ(min_windows(50ms),
              (std::vector<SensorDuration>{2ms, 3ms, 5ms, 7ms, 10ms, 15ms, 20ms, 30ms, 50ms}));
    EXPECT_EQ(min_windows(5ms), (std::vector<SensorDuration>{2ms, 3ms, 5ms}));
    EXPECT_EQ(min_windows(1ms), (std::vector<SensorDuration>{1ms}));
    const std::vector<SensorDuration> windows{2ms, 5ms};
    const std::vector<QualityLevel> order{{1, 0, 2ms},     {1, 0, 5ms},     {1, 1, 2ms},
                                          {1, 1, 5ms},     {1, 2, 2ms},     {1, 2, 5ms},
                                          {third, 0, 2ms}, {third, 0, 5ms}, {third, 1, 2ms},
                                          {third, 1, 5ms}, {third, 2, 2ms}, {third, 2, 5ms}};
    EXPECT_EQ(quality_levels({1, 0}, true, true, windows), order);
    EXPECT_EQ(quality_levels({1, 0}, false, false, windows),
              (std::vector<QualityLevel>{{1, 0, 2ms}, {1, 0, 5ms}}));
}

TEST(QualityChoice, CountsAsManyEventWindowsAsThereCanBe) {
    using namespace std::chrono_literals;
    QualityDemand demand = usual(30);
    EXPECT_DOUBLE_EQ(windows_at({1, 0}, demand), 20);
    EXPECT_DOUBLE_EQ(windows_at({1, 0, 5ms}, demand), 200);
    EXPECT_DOUBLE_EQ(load_of(kCosts[0], {1, 0, 20ms}, demand).encode, 50 * 10e-3);
    EXPECT_DOUBLE_EQ(load_of(kCosts[0], {1, 0, 20ms}, demand).frames, 30 * 4e-3)
        << "fewer than event windows";
    demand.pace = .5;
    EXPECT_DOUBLE_EQ(windows_at({1, 0, 5ms}, demand), 100) << "of the clock on the wall";
    demand = usual(30);
    demand.threads = 2;  // 1.19 cores; f32 takes 1 at 10 ms
    const auto levels = quality_levels({1, 0}, true, true, min_windows(50ms));
    EXPECT_EQ(best_that_holds(kFloat, levels, demand)->level, (QualityLevel{1, 0, 10ms}));
}

TEST(QualityChoice, LeavesAloneWhatWasGiven) {
    EXPECT_EQ(quality_levels({2.5, 0}, false, false), (std::vector<QualityLevel>{{2.5, 0}}));
    EXPECT_EQ(quality_levels({1, 0}, true, false),
              (std::vector<QualityLevel>{{1, 0}, {1, 1}, {1, 2}}));
    EXPECT_EQ(quality_levels({1, 0}, false, true), (std::vector<QualityLevel>{{1, 0}, {third, 0}}));
}

TEST(QualityChoice, SaysThatNothingHoldsAndWhatIsLeast) {
    const auto levels = quality_levels({1, 0}, true, true);
    QualityDemand demand = usual();
    demand.share = 0.05;
    EXPECT_FALSE(best_that_holds(kCosts, levels, demand));
    const QualityChoice least = least_load(kCosts, levels, demand);
    EXPECT_FALSE(least.holds);
    EXPECT_EQ(least.level, (QualityLevel{third, 2}));
    EXPECT_EQ(least.precision, Precision::bf16);
}

TEST(QualityChoice, MoreThreadsHoldMoreAndABudgetNoMoreThanThePace) {
    QualityDemand demand = usual();
    const double one = affordable_load(demand);
    demand.threads = 4;
    EXPECT_GT(affordable_load(demand), 2 * one);
    EXPECT_LT(affordable_load(demand), 4 * one);
    demand.share = 100;
    EXPECT_LT(affordable_load(demand), 4);
    demand.share = 0.1;
    EXPECT_DOUBLE_EQ(affordable_load(demand), 0.1 * cores_of(4) / 4) << "all of them cost";
}

TEST(Budget, IsATimeForEachFrameOrAShareOfACore) {
    EXPECT_DOUBLE_EQ(*parse_budget("8ms").cores(30), 0.24);
    EXPECT_DOUBLE_EQ(*parse_budget("50%").cores(30), 0.5);
    EXPECT_FALSE(parse_budget("none").cores(30));
    for (const char* text : {"8ms", "50%", "250%", "none", "500us"})
        EXPECT_EQ(show_budget(parse_budget(text)), text);
    for (const char* text : {"8", "", "%", "0ms", "-1ms", "0%", "fast", "nan%"})
        EXPECT_THROW(parse_budget(text), Error) << text;
}

}  // namespace
}  // namespace eventide::app
