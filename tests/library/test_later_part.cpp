// What a reader gives after a jump.
#include "library/later_part.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace eventide {
namespace {

std::vector<std::int64_t> times_after_a_jump(LaterPart& later,
                                             const std::vector<std::int64_t>& times) {
    Batch batch;
    for (const std::int64_t t : times) batch.events.push_back({from_us(t)});
    later.take(batch);
    std::vector<std::int64_t> left;
    for (const Event& event : batch.events) left.push_back(to_us(event.t));
    return left;
}

using Times = std::vector<std::int64_t>;

TEST(LaterPart, BeginsWithTheFirstEventOfThatTimeOrALaterOne) {
    LaterPart later;
    EXPECT_EQ(times_after_a_jump(later, {1, 2, 3}), (Times{1, 2, 3})) << "no jump";
    later.begin(from_us(20));
    EXPECT_EQ(times_after_a_jump(later, {1, 2, 3}), Times{});
    EXPECT_EQ(times_after_a_jump(later, {}), Times{});
    EXPECT_EQ(times_after_a_jump(later, {18, 19, 20, 20, 21}), (Times{20, 20, 21}));
}

TEST(LaterPart, HoldsTheEventsOfANewClockHoweverEarlyTheyAre) {
    LaterPart later;
    later.begin(from_us(20));
    EXPECT_EQ(times_after_a_jump(later, {10, 30, 0, 5}), (Times{30, 0, 5}));
    EXPECT_EQ(times_after_a_jump(later, {6, 7}), (Times{6, 7}));
    later.begin(from_us(7));
    EXPECT_EQ(times_after_a_jump(later, {6, 7}), Times{7});
}

TEST(LaterPart, LeavesOutEarlyImagesSamplesAndTriggersToo) {
    Batch batch;
    for (const std::int64_t t : {10, 30}) {
        batch.images.push_back({.t = from_us(t)});
        batch.imu.push_back({.t = from_us(t)});
        batch.triggers.push_back({.t = from_us(t)});
    }
    LaterPart later;
    later.begin(from_us(20));
    later.take(batch);
    ASSERT_EQ(batch.images.size(), 1U);
    EXPECT_EQ(batch.images[0].t, from_us(30));
    EXPECT_EQ(batch.imu.size(), 1U);
    EXPECT_EQ(batch.triggers.size(), 1U);
}

/// A camera reads an image out after the events of its time.
TEST(LaterPart, LeavesOutAnEarlyImageBehindTheFirstEventUpToTheNewClock) {
    const auto image_passes = [](LaterPart& later, std::int64_t t) {
        Batch batch;
        batch.images.push_back({.t = from_us(t)});
        later.take(batch);
        return !batch.images.empty();
    };
    LaterPart later;
    later.begin(from_us(20));
    EXPECT_EQ(times_after_a_jump(later, {30}), Times{30});
    EXPECT_FALSE(image_passes(later, 19));
    EXPECT_TRUE(image_passes(later, 20));
    EXPECT_EQ(times_after_a_jump(later, {5}), Times{5});
    EXPECT_TRUE(image_passes(later, 6));
}

}  // namespace
}  // namespace eventide
