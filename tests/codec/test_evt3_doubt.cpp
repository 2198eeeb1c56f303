// EVT3: high times that leap, fall or contradict each other, and what was said at them.
#include "tests/codec/evt3_checks.h"

namespace eventide::evt3 {
namespace {

/// A word and an event at column x, so that what became of the word shows.
Words at(unsigned high, unsigned x) {
    return {time_high(high), addr_y(1), addr_x(x)};
}
Words operator+(Words a, const Words& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}
Event event_at(unsigned high, int x) {
    return event(high * kHigh, x, 1);
}

TEST(Evt3Doubt, ATenthOfASecondIsNoLeapAndMoreWaits) {
    constexpr unsigned kLongest = 24;  // of 4.096 ms
    for (const unsigned step : {kLongest, kLongest + 1}) {
        Evt3Parser parser(kWidth, kHeight);
        Batch batch;
        parser.parse(to_stream(at(100, 1) + at(100, 2) + at(100 + step, 3)), batch);
        EXPECT_EQ(batch.events.size(), step == kLongest ? 3U : 2U) << step;
    }
}

TEST(Evt3Doubt, AFallOfHalfTheRangeIsAWrapAndASmallerOneIsNot) {
    const Parsed wrap = parse(at(3000, 1) + at(3000, 2) + at(952, 3) + at(952, 4));
    expect_events(wrap, {event_at(3000, 1), event_at(3000, 2), event_at(4096 + 952, 3),
                         event_at(4096 + 952, 4)});
    const Parsed fall = parse(at(3000, 1) + at(3000, 2) + at(953, 3) + at(953, 4));
    expect_events(fall, {event_at(3000, 1), event_at(3000, 2)});
    EXPECT_EQ(fall.damage[DamageReason::time_backwards], 2U);
}

TEST(Evt3Doubt, OfALeapAtWhichWordsWereLostNothingComes) {
    Evt3Parser parser(kWidth, kHeight);
    Batch batch;
    parser.parse(to_stream(at(100, 1) + at(100, 2) + at(1500, 3)), batch);
    parser.resync();
    parser.parse(to_stream(at(1500, 4)), batch);
    parser.finish(batch);
    EXPECT_EQ(batch.events, (std::vector{event_at(100, 1), event_at(100, 2), event_at(1500, 4)}));
    EXPECT_EQ(parser.damaged()[DamageReason::bad_record], 2U) << "the word and its event";
    EXPECT_EQ(parser.damaged().total(), 2U);
}

/// A camera begins at zero: a larger time before it was from an earlier run, or damage.
TEST(Evt3Doubt, AFirstTimeAfterWhichTheLastIsSmallerIsDamage) {
    const Parsed parsed = parse(at(2000, 1) + at(5, 2));
    expect_events(parsed, {event_at(5, 2)});
    EXPECT_EQ(parsed.damage[DamageReason::bad_record], 2U);
}

TEST(Evt3Doubt, AFirstTimeWithWhichTheNextTwoDisagreeIsDamage) {
    const Parsed below = parse(at(2000, 1) + at(5, 2) + at(6, 3));
    expect_events(below, {event_at(5, 2), event_at(6, 3)});
    EXPECT_EQ(below.damage[DamageReason::bad_record], 2U);
}

TEST(Evt3Doubt, AFallIsLeftWhereWhatFollowsIsPastAllBefore) {
    for (const unsigned next : {300U, 101U}) {
        Words words = at(100, 1) + at(100, 2);
        words.push_back(time_high(2));
        words.push_back(ext_trigger(0, true));
        const Parsed parsed = parse(words + at(next, 3) + at(next, 4));
        expect_events(parsed,
                      {event_at(100, 1), event_at(100, 2), event_at(next, 3), event_at(next, 4)});
        EXPECT_TRUE(parsed.data.triggers.empty()) << "it has no time";
        EXPECT_EQ(parsed.damage[DamageReason::bad_record], 2U);
    }
}

TEST(Evt3Doubt, ALeapIsLeftWhereTimeGoesOnAsBefore) {
    const Parsed parsed = parse(at(100, 1) + at(100, 2) + at(900, 3) + at(101, 4) + at(102, 5));
    expect_events(parsed, {event_at(100, 1), event_at(100, 2), event_at(101, 4), event_at(102, 5)});
    EXPECT_EQ(parsed.damage[DamageReason::bad_record], 2U);
}

/// Silence, and after it words far apart: each is later than the one before.
TEST(Evt3Doubt, LeapsOfWhichEachGoesOnAreBelieved) {
    const Parsed parsed = parse(at(100, 1) + at(100, 2) + at(400, 3) + at(700, 4) + at(1000, 5));
    expect_events(parsed, {event_at(100, 1), event_at(100, 2), event_at(400, 3), event_at(700, 4),
                           event_at(1000, 5)});
    EXPECT_EQ(parsed.damage.total(), 0U);
}

/// From the leap on, time could have wrapped to be where it was.
TEST(Evt3Doubt, ALeapOfMoreThanHalfTheRangeIsLeftWhereTimeGoesOnAsBefore) {
    const Parsed parsed = parse(at(100, 1) + at(100, 2) + at(3000, 3) + at(101, 4) + at(102, 5));
    expect_events(parsed, {event_at(100, 1), event_at(100, 2), event_at(101, 4), event_at(102, 5)});
    EXPECT_EQ(parsed.damage[DamageReason::bad_record], 2U);
}

constexpr HostTime host_at(std::int64_t us) {
    return HostTime{std::chrono::microseconds{us}};
}

/// It counts from 10, and as much later as the host's clock says.
TEST(Evt3Doubt, OfACameraThatWasOpenedAgainLeapsAndLossesAreJudgedAsBefore) {
    Evt3Parser parser(kWidth, kHeight);
    Batch batch;
    parser.arrives(host_at(0));
    parser.parse(to_stream(at(100, 1) + at(100, 2)), batch);
    parser.reopened();
    parser.arrives(host_at(1000 * kHigh));
    parser.parse(to_stream(at(10, 3) + at(11, 4) + at(900, 5) + at(12, 6) + at(13, 7)), batch);
    parser.resync();
    parser.arrives(host_at(3000 * kHigh));  // held up: no time passed
    parser.parse(to_stream(at(14, 8) + at(15, 9)), batch);
    EXPECT_EQ(batch.events, (std::vector{event_at(100, 1), event_at(100, 2), event_at(1101, 3),
                                         event_at(1102, 4), event_at(1103, 6), event_at(1104, 7),
                                         event_at(1105, 8), event_at(1106, 9)}));
    EXPECT_EQ(parser.damaged()[DamageReason::bad_record], 2U);
    EXPECT_EQ(parser.damaged().total(), 2U);
}

}  // namespace
}  // namespace eventide::evt3
