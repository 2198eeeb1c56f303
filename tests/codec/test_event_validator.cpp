// The rules every event passes, where a stream is taken up again.
#include "src/codec/event_validator.h"

#include <gtest/gtest.h>

#include <limits>

namespace eventide {
namespace {

/// Of one event before a loss and two after it, at these times in us.
std::vector<std::int64_t> times_around_loss(std::int64_t before, std::int64_t after,
                                            Damage& damage) {
    EventValidator validator(10, 10);
    Batch batch;
    validator.add(before, 1, 1, true, batch, damage);
    validator.resync(damage);
    validator.add(after, 2, 2, true, batch, damage);
    validator.add(after, 3, 2, true, batch, damage);
    validator.finish(batch, damage);
    std::vector<std::int64_t> times;
    for (const Event& event : batch.events) times.push_back(to_us(event.t));
    return times;
}

// Taken up anywhere in time, the events that come out are in order all the same: the one that was
// held until another agreed with it is of before the loss, and goes with it.
TEST(EventValidator, AnEventHeldWhereALossBeginsIsLostAndCounted) {
    Damage expected;
    expected.count(DamageReason::truncated);
    for (const std::int64_t after : {100, 500, 900'000}) {
        Damage damage;
        EXPECT_EQ(times_around_loss(500, after, damage), (std::vector<std::int64_t>{after, after}));
        EXPECT_EQ(damage, expected) << after;
    }
}

// Also where nothing follows that contradicts them, at the end and alone.
TEST(EventValidator, TimesThatAreNoneAreLeftOutWhereverTheyStand) {
    constexpr std::int64_t kFarthest = EventValidator::kFarthest;
    constexpr auto kMin = std::numeric_limits<std::int64_t>::min();
    constexpr auto kMax = std::numeric_limits<std::int64_t>::max();
    for (const std::int64_t bad : {kFarthest + 1, -kFarthest - 1, kMin, kMax}) {
        EventValidator validator(10, 10);
        Batch batch;
        Damage damage, expected;
        for (const std::int64_t t : {bad, std::int64_t{100}, std::int64_t{200}, bad, bad})
            validator.add(t, 1, 1, true, batch, damage);
        validator.finish(batch, damage);
        ASSERT_EQ(batch.events.size(), 2U) << bad;
        EXPECT_EQ(validator.newest_us(), 200);
        expected.count(DamageReason::bad_record, 3);
        EXPECT_EQ(damage, expected) << bad;
    }
}

// A leap of a second, and what follows it: at the same time, later, or before it.
TEST(EventValidator, ALeapIsBelievedWhenWhatFollowsDoesNotLieBeforeIt) {
    const auto events_of = [](std::int64_t next_us) {
        EventValidator validator(10, 10);
        Batch batch;
        Damage damage;
        for (const std::int64_t t :
             {std::int64_t{100}, std::int64_t{200}, std::int64_t{1'000'200}, next_us})
            validator.add(t, 1, 1, true, batch, damage);
        return batch.events.size();
    };
    EXPECT_EQ(events_of(1'000'200), 4U);
    EXPECT_EQ(events_of(1'000'300), 4U);
    EXPECT_EQ(events_of(1'000'199), 2U) << "and is a leap itself";
    EXPECT_EQ(events_of(300), 3U);
}

struct Judged {
    std::vector<std::int64_t> times;  // us, of the events taken
    std::uint64_t bad = 0, backwards = 0;

    friend bool operator==(const Judged&, const Judged&) = default;
};

/// Of packets with events at these times in us.
Judged judge(const std::vector<std::vector<std::int64_t>>& packets,
             EventValidator::LeapEnds leap_ends = EventValidator::LeapEnds::with_next_event) {
    EventValidator validator(10, 10, leap_ends);
    Batch batch;
    Damage damage;
    for (const auto& packet : packets) {
        for (const std::int64_t t : packet) validator.add(t, 1, 1, true, batch, damage);
        validator.end_packet();
    }
    validator.finish(batch, damage);
    Judged judged;
    for (const Event& event : batch.events) judged.times.push_back(to_us(event.t));
    judged.bad = damage[DamageReason::bad_record];
    judged.backwards = damage[DamageReason::time_backwards];
    return judged;
}

constexpr std::int64_t kStep = 100'000, kPause = 60'000'000;  // us
static_assert(kStep == EventValidator::kLongestStep);
static_assert(kPause == EventValidator::kLongestFirstPause);

TEST(EventValidator, ATenthOfASecondIsNoLeapAndMoreIsOne) {
    EXPECT_EQ(judge({{0, 0, kStep, 50}}), (Judged{{0, 0, kStep}, 0, 1}));
    EXPECT_EQ(judge({{0, 0, kStep + 1, 50}}), (Judged{{0, 0, 50}, 1, 0}));
}

TEST(EventValidator, AFirstEventATenthOfASecondTooLateIsBelievedAndALaterOneIsNot) {
    EXPECT_EQ(judge({{kStep, 0, kStep}}), (Judged{{kStep, kStep}, 0, 1}));
    EXPECT_EQ(judge({{kStep + 1, 0, 1}}), (Judged{{0, 1}, 1, 0}));
}

TEST(EventValidator, AFirstEventAMinuteTooEarlyIsBelievedAndAnEarlierOneIsNot) {
    EXPECT_EQ(judge({{0, kPause, kPause}}), (Judged{{0, kPause, kPause}, 0, 0}));
    EXPECT_EQ(judge({{0, kPause + 1, kPause + 1}}), (Judged{{kPause + 1, kPause + 1}, 1, 0}));
}

TEST(EventValidator, InPacketsALeapIsJudgedByTheNextPacketOrTheEnd) {
    constexpr auto kPackets = EventValidator::LeapEnds::with_next_packet;
    constexpr std::int64_t kFar = 5 * kPause;
    EXPECT_EQ(judge({{0, 1, kFar, kFar, kFar + 1}, {3}}, kPackets), (Judged{{0, 1, 3}, 3, 0}));
    EXPECT_EQ(judge({{0, 1, kFar, kFar, 2}, {3}}, kPackets), (Judged{{0, 1, 2, 3}, 2, 0}))
        << "or by what lies before it";
    EXPECT_EQ(judge({{0, 1, kFar, kFar + 5, kFar + 3, kFar + 5}, {kFar + 6}}, kPackets),
              (Judged{{0, 1, kFar, kFar + 5, kFar + 5, kFar + 6}, 0, 1}));
    EXPECT_EQ(judge({{0, 1, kFar, kFar}}, kPackets), (Judged{{0, 1, kFar, kFar}, 0, 0}));
    EXPECT_EQ(judge({{0, kFar, kFar}}, kPackets), (Judged{{kFar, kFar}, 1, 0}))
        << "two agree against the first";
}

TEST(EventValidator, AllThatIsHeldWhereALossBeginsIsLostAndCounted) {
    EventValidator validator(10, 10, EventValidator::LeapEnds::with_next_packet);
    Batch batch;
    Damage damage;
    for (const std::int64_t t : {std::int64_t{0}, kPause, kPause})
        validator.add(t, 1, 1, true, batch, damage);
    validator.resync(damage);
    EXPECT_TRUE(batch.events.empty());
    EXPECT_EQ(damage[DamageReason::truncated], 3U);
}

}  // namespace
}  // namespace eventide
