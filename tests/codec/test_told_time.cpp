// Which times a recording is believed to have reached.
#include "src/codec/told_time.h"

#include <gtest/gtest.h>

namespace eventide {
namespace {

constexpr std::int64_t kNow = 1'000'000, kStep = EventValidator::kLongestStep,
                       kFar = kNow + 3'600'000'000;  // us

/// An event told kNow, then packets of other data one time each.
ToldTime after(std::initializer_list<std::int64_t> packets) {
    ToldTime time;
    time.tell_by_events(kNow);
    for (const std::int64_t t : packets) {
        time.tell(t);
        time.end_packet();
    }
    return time;
}

TEST(ToldTime, ALeapIsBelievedOnceTheNextPacketDoesNotLieBeforeIt) {
    EXPECT_EQ(after({kFar}).newest_us(), kNow);
    EXPECT_EQ(after({kFar, kFar}).newest_us(), kFar);
    EXPECT_EQ(after({kNow + kStep}).newest_us(), kNow + kStep) << "no leap";
    EXPECT_EQ(after({kNow + kStep + 1}).newest_us(), kNow);
}

TEST(ToldTime, ALeapThatWasContradictedIsForgotten) {
    ToldTime by_other = after({kFar, kNow + 1}), by_events = after({kFar});
    by_events.tell_by_events(kNow + 1);
    for (ToldTime* time : {&by_other, &by_events}) {
        time->finish();
        EXPECT_EQ(time->newest_us(), kNow + 1);
    }
}

TEST(ToldTime, EventsNearALeapDoNotContradictIt) {
    ToldTime time = after({kFar});
    time.tell_by_events(kFar - kStep);
    time.finish();
    EXPECT_EQ(time.newest_us(), kFar);
}

TEST(ToldTime, NothingContradictsTheLastLeapOfAStream) {
    ToldTime time = after({kFar});
    time.finish();
    EXPECT_EQ(time.newest_us(), kFar);
}

TEST(ToldTime, NeverGoesBackAndOfAPacketTheNewestCounts) {
    EXPECT_EQ(after({kNow - 1}).newest_us(), kNow);
    ToldTime time = after({});
    time.tell(kNow + 20);
    time.tell(kNow + 10);
    time.end_packet();
    EXPECT_EQ(time.newest_us(), kNow + 20);
}

}  // namespace
}  // namespace eventide
