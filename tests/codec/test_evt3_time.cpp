// EVT3's time: 24 bits that wrap, damaged ones, and those of a camera that was away.
#include "tests/codec/evt3_checks.h"

#include <string>

namespace eventide::evt3 {
namespace {

TEST(Evt3, TimeWrapsAndGoesOn) {
    const std::int64_t wrap = 1 << 24;
    expect_events(parse({time_high(4095), time_low(4095), addr_y(1), addr_x(1), time_high(0),
                         addr_x(2), time_low(5), addr_x(3)}),
                  {event(wrap - 1, 1, 1), event(wrap, 2, 1), event(wrap + 5, 3, 1)});
    Words words{time_high(0), addr_y(0)};
    for (unsigned i = 1; i <= 100; ++i) words.push_back(time_high(i * 200 % 4096));
    words.push_back(addr_x(9));
    expect_events(parse(words), {event(100 * 200 * kHigh, 9, 0)});
}

TEST(Evt3, AFallSmallerThanAWrapIsNoise) {
    const Parsed parsed = parse({time_high(100), addr_y(1), addr_x(1), time_high(99), addr_x(2),
                                 time_high(101), addr_x(3)});
    expect_events(parsed, {event(100 * kHigh, 1, 1), event(101 * kHigh, 3, 1)});
    EXPECT_EQ(parsed.damage[DamageReason::time_backwards], 1U);
    EXPECT_EQ(parsed.damage.total(), 1U);
}

TEST(Evt3, AFlippedHighTimeCostsOnlyWhatFollowsIt) {
    for (unsigned bit = 10; bit < 12; ++bit) {
        const Parsed parsed =
            parse({time_high(100), addr_y(1), addr_x(1), time_high(101 ^ 1U << bit), addr_x(2),
                   time_high(102), addr_x(3)});
        expect_events(parsed, {event(100 * kHigh, 1, 1), event(102 * kHigh, 3, 1)});
        EXPECT_EQ(parsed.damage[DamageReason::bad_record], 2U);
    }
}

TEST(Evt3, AFlippedBitOfAnyHighTimeCostsATenthOfASecond) {
    for (const unsigned first : {0x5A5U, 0xFFFU - 20U}) {  // the second wraps
        std::vector<Event> events;
        Words words;
        for (unsigned i = 0; i < 60; ++i) {
            words.insert(words.end(), {time_high((first + i) & 0xFFF), addr_y(1), addr_x(i)});
            events.push_back(event((first + i) * kHigh, int(i), 1));
        }
        expect_events(parse(words), events);
        for (std::size_t at = 0; at < words.size(); at += 3)
            for (unsigned bit = 0; bit < 12; ++bit) {
                Words flipped = words;
                flipped[at] = std::uint16_t(flipped[at] ^ 1U << bit);
                expect_most_events_kept(parse(flipped), events, 25,
                                        std::to_string(at) + ", bit " + std::to_string(bit));
            }
    }
}

TEST(Evt3, ATimeInDoubtDoesNotMoveTheClock) {
    Evt3Parser parser(kWidth, kHeight);
    Batch batch;
    parser.parse(to_stream({time_high(100), time_high(100), time_high(612), time_low(5)}), batch);
    EXPECT_EQ(parser.clock(), from_us(100 * kHigh));
    parser.parse(to_stream({time_high(612)}), batch);
    EXPECT_EQ(parser.clock(), from_us(612 * kHigh + 5));
}

TEST(Evt3, ALeapThatIsConfirmedIsBelieved) {
    const Parsed parsed =
        parse({time_high(100), addr_y(1), addr_x(1), time_high(1500), time_high(1500), addr_x(2)});
    expect_events(parsed, {event(100 * kHigh, 1, 1), event(1500 * kHigh, 2, 1)});
    EXPECT_EQ(parsed.damage.total(), 0U);
}

TEST(Evt3, TheClockGoesOnWithoutEvents) {
    EXPECT_EQ(parse({}).clock, std::nullopt);
    EXPECT_EQ(parse({time_high(5)}).clock, from_us(5 * kHigh));
    EXPECT_EQ(parse({time_high(5), time_low(7)}).clock, from_us(5 * kHigh + 7));
}

TEST(Evt3, AfterALossItTakesUpAtTheNextTime) {
    Evt3Parser parser(kWidth, kHeight);
    Batch batch;
    parser.parse(to_stream({time_high(4095), addr_y(1), addr_x(1)}), batch);
    parser.resync();
    parser.parse(to_stream({addr_x(2), time_high(2), addr_x(3), addr_y(4), addr_x(5)}), batch);
    parser.finish(batch);
    const std::vector<Event> expected{event(4095 * kHigh, 1, 1), event(4098 * kHigh, 5, 4)};
    EXPECT_TRUE(batch.events == expected);
}

TEST(Evt3, TheLowBitsOfATimeAreNotThoseFromBeforeALoss) {
    Evt3Parser parser(kWidth, kHeight);
    Batch batch;
    parser.parse(to_stream({time_high(7), time_high(7), time_low(900), addr_y(1), addr_x(1)}),
                 batch);
    parser.resync();
    parser.parse(
        to_stream({time_high(7), addr_y(4), addr_x(5), time_high(7), time_low(20), addr_x(6)}),
        batch);
    parser.finish(batch);
    const std::vector<Event> expected{event(7 * kHigh + 900, 1, 1), event(7 * kHigh, 5, 4),
                                      event(7 * kHigh + 20, 6, 4)};
    EXPECT_TRUE(batch.events == expected);
    EXPECT_EQ(parser.damaged().total(), 0U);
}

TEST(Evt3, AfterAJumpBackReadingGoesOnThere) {
    Evt3Parser parser(kWidth, kHeight);
    Batch batch;
    parser.parse(to_stream({time_high(500), time_high(500), addr_y(1), addr_x(1)}), batch);
    parser.resync();
    EXPECT_EQ(parser.clock(), std::nullopt);
    batch.clear();
    parser.parse(to_stream({time_high(100), time_high(100), addr_y(2), addr_x(3)}), batch);
    EXPECT_EQ(batch.events, std::vector{event(100 * kHigh, 3, 2)});
    EXPECT_EQ(parser.damaged().total(), 0U);
}

constexpr HostTime host_at(std::int64_t us) {
    return HostTime{std::chrono::microseconds{us}};
}

/// What a camera tells that has seen times up to 10 s, was away for a minute and says these words.
std::vector<Event> after_coming_back(const Words& words, DamageReason counted,
                                     std::uint64_t times) {
    Evt3Parser parser(kWidth, kHeight);
    Batch batch;
    parser.arrives(host_at(5000));
    parser.parse(to_stream({time_high(2440), time_high(2441)}), batch);
    parser.reopened();
    parser.arrives(host_at(5000 + 60'000'000));
    parser.parse(to_stream(words), batch);
    parser.finish(batch);
    EXPECT_EQ(parser.damaged()[counted], times);
    EXPECT_EQ(parser.damaged().total(), times);
    return batch.events;
}

TEST(Evt3, ACameraThatWasOpenedAgainGoesOnByTheHostsClock) {
    constexpr std::int64_t kBack = (2442 + 60'000'000 / kHigh) * kHigh;
    for (const unsigned begin : {0U, 2000U, 2441U, 4095U}) {
        const unsigned next = (begin + 1) % 4096;
        EXPECT_EQ(after_coming_back({time_high(begin), time_low(7), addr_y(4), addr_x(5),
                                     time_high(next), time_low(3), addr_x(6)},
                                    DamageReason::bad_record, 0),
                  (std::vector{event(kBack + 7, 5, 4), event(kBack + kHigh + 3, 6, 4)}))
            << begin;
    }
    // One from before its clock was set to zero.
    EXPECT_EQ(after_coming_back({time_high(1500), time_high(0), time_low(7), addr_y(4), addr_x(5),
                                 time_high(1), time_low(3), addr_x(6)},
                                DamageReason::bad_record, 1),
              (std::vector{event(kBack + 7, 5, 4), event(kBack + kHigh + 3, 6, 4)}));
}

TEST(Evt3, ACameraThatIsOpenedAgainAtOnceIsNotInThePast) {
    Evt3Parser parser(kWidth, kHeight);
    Batch batch;
    parser.arrives(host_at(0));
    parser.parse(to_stream({time_high(9), time_high(9), time_low(4000), addr_y(1), addr_x(1)}),
                 batch);
    for (int times = 0; times < 3; ++times) {
        parser.reopened();
        parser.arrives(host_at(0));
        parser.parse(to_stream({time_high(0), time_high(0), time_low(1), addr_y(1), addr_x(1)}),
                     batch);
    }
    const std::vector<Event> expected{event(9 * kHigh + 4000, 1, 1), event(10 * kHigh + 1, 1, 1),
                                      event(11 * kHigh + 1, 1, 1), event(12 * kHigh + 1, 1, 1)};
    EXPECT_EQ(batch.events, expected);
}

/// Two words that tell this time, and an event.
std::vector<std::byte> words_at(std::int64_t us) {
    const auto high = unsigned(us / kHigh % 4096);
    return to_stream({time_high(high), time_high(high), addr_y(1), addr_x(1)});
}

/// 24 bits are 16.8 s.
TEST(Evt3, ALossIsAsLongAsTheHostsClockSays) {
    for (std::int64_t before = 1'000'000; before < 17'000'000; before += 1'310'720)
        for (std::int64_t lost = 100'000; lost < 40'000'000; lost += 1'720'320) {
            Evt3Parser parser(kWidth, kHeight);
            Batch batch;
            parser.arrives(host_at(before));
            parser.parse(words_at(before), batch);
            parser.resync();
            parser.arrives(host_at(before + lost + 5000));  // later than others
            parser.parse(words_at(before + lost), batch);
            ASSERT_EQ(batch.events, (std::vector{event(before / kHigh * kHigh, 1, 1),
                                                 event((before + lost) / kHigh * kHigh, 1, 1)}))
                << lost << " us lost at " << before;
            EXPECT_EQ(parser.damaged().total(), 0U);
        }
}

/// A program that was stopped takes what the driver had kept, and then what comes behind the loss,
/// both at once.
TEST(Evt3, NoLossIsBackInTime) {
    for (const std::int64_t lost : {3'000'000, 9'000'000, 16'000'000}) {
        Evt3Parser parser(kWidth, kHeight);
        Batch batch;
        parser.arrives(host_at(60'000'000));
        parser.parse(words_at(16'000'000), batch);
        parser.resync();
        parser.arrives(host_at(60'001'000));
        parser.parse(words_at(16'000'000 + lost), batch);
        EXPECT_EQ(parser.clock(), from_us((16'000'000 + lost) / kHigh * kHigh)) << lost;
    }
}

TEST(Evt3, AWordThatLiesBehindALossHasNoSayInTheNext) {
    Evt3Parser parser(kWidth, kHeight);
    Batch batch;
    parser.arrives(host_at(0));
    parser.parse(to_stream({time_high(500), time_high(500), addr_y(1), addr_x(1)}), batch);
    parser.resync();
    parser.arrives(host_at(100'000));
    parser.parse(to_stream({time_high(400), time_high(520), addr_y(1), addr_x(2), time_high(520),
                            addr_x(3)}),
                 batch);
    EXPECT_EQ(batch.events, (std::vector{event(500 * kHigh, 1, 1), event(520 * kHigh, 2, 1),
                                         event(520 * kHigh, 3, 1)}));
}

}  // namespace
}  // namespace eventide::evt3
