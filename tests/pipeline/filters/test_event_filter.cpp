// What a user chose is what filters.
#include "pipeline/filters/event_filter.h"

#include "src/core/error.h"

#include <gtest/gtest.h>

namespace eventide {
namespace {

std::vector<Event> three_together_and_one_alone() {
    const auto at = [](std::int64_t us, int x, int y) {
        return Event{from_us(us), std::uint16_t(x), std::uint16_t(y), Polarity::on};
    };
    return {at(0, 2, 2), at(1, 3, 2), at(2, 2, 3), at(3, 8, 8)};
}

/// How many of the four stay.
std::size_t kept(const char* noise_filter, bool trained_so) {
    ModelConfig model;
    model.noise_filter = trained_so;
    const auto filter = event_filter({"off", noise_filter}, model, 16, 16);
    std::vector<Event> events = three_together_and_one_alone();
    if (filter) filter->process(events);
    return events.size();
}

TEST(EventFilter, LeavesOutNoiseWhereAskedOrWhereTheModelWasTrainedSo) {
    EXPECT_EQ(kept("off", true), 4U);
    EXPECT_EQ(kept("model", false), 4U);
    EXPECT_EQ(kept("model", true), 2U);
    EXPECT_EQ(kept("auto", false), 2U);
    EXPECT_EQ(kept("10ms", false), 2U);
    EXPECT_EQ(kept("1us", false), 1U) << "the first of a stream stays";
    EXPECT_THROW(kept("a lot", false), Error);
}

TEST(EventFilter, IsNoneWhereAllEventsStay) {
    EXPECT_EQ(event_filter({"off", "off", "off"}, {}, 16, 16), nullptr);
    EXPECT_NE(event_filter({"learn", "off", "off"}, {}, 16, 16), nullptr);
    EXPECT_NE(event_filter({"off", "off", "auto"}, {}, 16, 16), nullptr);
}

}  // namespace
}  // namespace eventide
