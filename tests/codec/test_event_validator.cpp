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

}  // namespace
}  // namespace eventide
