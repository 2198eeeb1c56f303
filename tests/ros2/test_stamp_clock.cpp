// Stamps of frames: ROS time, always rising.
#include "pipeline/ros2/message_parts.h"
#include "pipeline/ros2/stamp_clock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <string>
#include <utility>

namespace eventide {
namespace {

constexpr std::int64_t kNow = 1'790'000'000'000'000;  // us since 1970

Frame frame_at(std::int64_t t_us, std::int64_t window_end_us) {
    Frame frame;
    frame.t = from_us(t_us);
    frame.window = {from_us(window_end_us - 10'000), from_us(window_end_us)};
    return frame;
}

TEST(StampClock, ASensorThatCountsFromItsStartIsShiftedToItsArrival) {
    StampClock clock{StampRule::automatic, false};
    EXPECT_EQ(clock.stamp_us(frame_at(4'000, 10'000), kNow), kNow - 6'000);
    EXPECT_TRUE(clock.is_set_anew());
    EXPECT_EQ(clock.stamp_us(frame_at(14'000, 20'000), kNow + 99'000), kNow + 4'000)
        << "as far apart as in the sensor";
    EXPECT_FALSE(clock.is_set_anew());
}

TEST(StampClock, ASensorThatCountsFrom1970IsTakenAtItsWord) {
    StampClock clock{StampRule::automatic, true};
    const std::int64_t t = 1'633'953'690'975'951;
    EXPECT_EQ(clock.stamp_us(frame_at(t, t + 10), kNow), t);
    EXPECT_EQ(clock.offset_us(), 0);
    StampClock arrival{StampRule::arrival, true};
    EXPECT_EQ(arrival.stamp_us(frame_at(t, t + 10), kNow), kNow - 10);
    StampClock sensor{StampRule::sensor, true};
    EXPECT_EQ(sensor.stamp_us(frame_at(5, 10), kNow), 5);
}

TEST(StampClock, KnowsThatLaterWindowsCameWithLookahead) {
    StampClock clock{StampRule::arrival, false};
    clock.set_lookahead(2);
    EXPECT_EQ(clock.stamp_us(frame_at(10'000, 10'000), kNow), kNow - 20'000);
}

TEST(StampClock, AnotherLookaheadLeavesTheStampsWhereTheyAre) {
    StampClock clock{StampRule::arrival, true};
    std::int64_t t = 0;
    for (const int lookahead : {2, 0, 1})
        for (int k = 0; k < 1000; ++k) {
            t += 10'000;
            clock.set_lookahead(lookahead);
            ASSERT_EQ(clock.stamp_us(frame_at(t, t), kNow + t + 10'000 * lookahead), kNow + t)
                << lookahead << " event windows, frame " << k;
        }
}

TEST(StampClock, FollowsTheDriftOfACameraAndNotItsDelays) {
    StampClock clock{StampRule::arrival, true};
    constexpr double kDrift = 80e-6;  // the sensor is slow by so much
    std::int64_t before = 0;
    for (int k = 0; k < 60'000; ++k) {  // ten minutes
        const std::int64_t t = 10'000 * (k + 1);
        const auto true_arrival = kNow + std::int64_t(std::llround(double(t) * (1 + kDrift)));
        const std::int64_t delay = (k * 7919) % 5'000;  // up to 5 ms late
        const std::int64_t stamp = clock.stamp_us(frame_at(t, t), true_arrival + delay);
        EXPECT_GT(stamp, before) << k;
        if (k > 1000) {
            EXPECT_LE(std::abs(stamp - true_arrival), 300) << k;
        }
        before = stamp;
    }
}

/// The first packet was held up for 50 ms.
TEST(StampClock, AnOffsetThatWasTooLargeShrinksByAMillisecondASecond) {
    StampClock clock{StampRule::arrival, true};
    std::int64_t stamp = clock.stamp_us(frame_at(0, 0), kNow + 50'000);
    EXPECT_EQ(stamp, kNow + 50'000);
    for (int k = 1; k <= 50'000; ++k) {
        const std::int64_t t = 10'000 * k;
        const std::int64_t before = std::exchange(stamp, clock.stamp_us(frame_at(t, t), kNow + t));
        ASSERT_GE(stamp - before, 9'989) << k;
    }
    EXPECT_NEAR(double(stamp - kNow), 500'000'000., 1);
}

TEST(Header, HoldsMicrosecondsBeforeAndAfter1970) {
    const std::string frame_id = "camera";
    const auto stamp = [&](std::int64_t us) {
        const auto header = header_of(us, frame_id);
        EXPECT_STREQ(header.frame_id, "camera");
        return std::pair<int, unsigned>{header.stamp.sec, header.stamp.nanosec};
    };
    EXPECT_EQ(stamp(1'633'953'690'975'951), (std::pair{1'633'953'690, 975'951'000U}));
    EXPECT_EQ(stamp(0), (std::pair{0, 0U}));
    EXPECT_EQ(stamp(-1), (std::pair{-1, 999'999'000U}));
}

TEST(StampClock, OfARecordingTheOffsetStays) {
    StampClock clock{StampRule::arrival, false};
    const std::int64_t first = clock.stamp_us(frame_at(10'000, 10'000), kNow);
    EXPECT_EQ(clock.stamp_us(frame_at(20'000, 20'000), kNow + 5'000'000), first + 10'000)
        << "slower than recorded";
}

TEST(StampClock, RisesThoughTheCamerasClockBeginsAnew) {
    StampClock clock{StampRule::arrival, true};
    const std::int64_t before = clock.stamp_us(frame_at(5'000'000, 5'000'000), kNow);
    const std::int64_t after = clock.stamp_us(frame_at(1'000, 1'000), kNow + 50'000);
    EXPECT_TRUE(clock.is_set_anew());
    EXPECT_EQ(after, before + 50'000);
    StampClock sensor{StampRule::sensor, true};
    EXPECT_EQ(sensor.stamp_us(frame_at(5'000'000, 5'000'000), kNow), 5'000'000);
    EXPECT_EQ(sensor.stamp_us(frame_at(1'000, 1'000), kNow), 5'000'001);
}

}  // namespace
}  // namespace eventide
