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
constexpr SensorDuration kAhead{kNow};                // the system's clock, of the frames' arrival

Frame frame_at(std::int64_t t_us, std::int64_t window_end_us, std::int64_t arrived_us = 0) {
    Frame frame;
    frame.arrived = HostTime{SensorDuration{arrived_us}};
    frame.t = from_us(t_us);
    frame.window = {from_us(window_end_us - 10'000), from_us(window_end_us)};
    return frame;
}

TEST(StampClock, ASensorThatCountsFromItsStartIsShiftedToItsArrival) {
    StampClock clock{StampRule::automatic, false};
    EXPECT_EQ(clock.stamp_us(frame_at(4'000, 10'000), kAhead), kNow - 6'000);
    EXPECT_TRUE(clock.is_set_anew());
    EXPECT_EQ(clock.stamp_us(frame_at(14'000, 20'000, 99'000), kAhead), kNow + 4'000)
        << "as far apart as in the sensor";
    EXPECT_FALSE(clock.is_set_anew());
}

TEST(StampClock, ASensorThatCountsFrom1970IsTakenAtItsWord) {
    StampClock clock{StampRule::automatic, true};
    const std::int64_t t = 1'633'953'690'975'951;
    EXPECT_EQ(clock.stamp_us(frame_at(t, t + 10), kAhead), t);
    EXPECT_EQ(clock.offset_us(), 0);
    StampClock arrival{StampRule::arrival, true};
    EXPECT_EQ(arrival.stamp_us(frame_at(t, t + 10), kAhead), kNow - 10);
    StampClock sensor{StampRule::sensor, true};
    EXPECT_EQ(sensor.stamp_us(frame_at(5, 10), kAhead), 5);
}

TEST(StampClock, KnowsThatLaterWindowsCameWithLookahead) {
    StampClock clock{StampRule::arrival, false};
    clock.set_lookahead(2);
    EXPECT_EQ(clock.stamp_us(frame_at(10'000, 10'000), kAhead), kNow - 20'000);
}

TEST(StampClock, AnotherLookaheadLeavesTheStampsWhereTheyAre) {
    StampClock clock{StampRule::arrival, true};
    std::int64_t t = 0;
    for (const int lookahead : {2, 0, 1})
        for (int k = 0; k < 1000; ++k) {
            t += 10'000;
            clock.set_lookahead(lookahead);
            ASSERT_EQ(clock.stamp_us(frame_at(t, t, t + 10'000 * lookahead), kAhead), kNow + t)
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
        const std::int64_t stamp =
            clock.stamp_us(frame_at(t, t, true_arrival - kNow + delay), kAhead);
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
    std::int64_t stamp = clock.stamp_us(frame_at(0, 0, 50'000), kAhead);
    EXPECT_EQ(stamp, kNow + 50'000);
    for (int k = 1; k <= 50'000; ++k) {
        const std::int64_t t = 10'000 * k;
        const std::int64_t before = std::exchange(stamp, clock.stamp_us(frame_at(t, t, t), kAhead));
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
    const std::int64_t first = clock.stamp_us(frame_at(10'000, 10'000), kAhead);
    EXPECT_EQ(clock.stamp_us(frame_at(20'000, 20'000, 5'000'000), kAhead), first + 10'000)
        << "slower than recorded";
}

TEST(StampClock, RisesThoughTheCamerasClockBeginsAnew) {
    StampClock clock{StampRule::arrival, true};
    const std::int64_t before = clock.stamp_us(frame_at(5'000'000, 5'000'000), kAhead);
    const std::int64_t after = clock.stamp_us(frame_at(1'000, 1'000, 50'000), kAhead);
    EXPECT_TRUE(clock.is_set_anew());
    EXPECT_EQ(after, before + 50'000);
    StampClock sensor{StampRule::sensor, true};
    EXPECT_EQ(sensor.stamp_us(frame_at(5'000'000, 5'000'000), kAhead), 5'000'000);
    EXPECT_EQ(sensor.stamp_us(frame_at(1'000, 1'000), kAhead), 5'000'001);
}

/// A board without a battery learns the time while it runs.
TEST(StampClock, FollowsASystemsClockThatIsSet) {
    constexpr std::int64_t kHour = 3'600'000'000;
    for (const std::int64_t step : {kHour, -kHour, 600'000L, -600'000L}) {
        StampClock clock{StampRule::automatic, true};
        std::int64_t before = 0;
        for (int k = 0; k < 100; ++k) {
            const std::int64_t t = 10'000 * k;
            const std::int64_t expected = kNow + t + (k < 50 ? 0 : step);
            const std::int64_t stamp =
                clock.stamp_us(frame_at(t, t, t), SensorDuration{kNow + (k < 50 ? 0 : step)});
            EXPECT_EQ(stamp, expected) << k;
            EXPECT_EQ(clock.is_set_anew(), k == 0 || k == 50) << k;
            if (k != 50) {
                EXPECT_GT(stamp, before);
            }
            before = stamp;
        }
    }
}

TEST(StampClock, ASystemsClockThatIsSetChangesNothingThatDoesNotHangOnIt) {
    const auto both = [](StampClock clock) {
        const std::int64_t before = clock.stamp_us(frame_at(10'000, 10'000), kAhead);
        return clock.stamp_us(frame_at(20'000, 20'000, 9'000), kAhead + std::chrono::hours{1}) -
               before;
    };
    EXPECT_EQ(both({StampRule::sensor, true}), 10'000);
    EXPECT_EQ(both({StampRule::arrival, false}), 10'000) << "of a recording the offset stays";
}

}  // namespace
}  // namespace eventide
