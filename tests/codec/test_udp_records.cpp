// Records of UDP datagrams: any split, wraps, senders that begin anew.
#include "src/codec/udp_records.h"
#include "src/core/byte_order.h"
#include "tests/codec/parser_checks.h"

#include <gtest/gtest.h>

namespace eventide {
namespace {

TEST(UdpRecords, BearSplitsAndCuts) {
    for (const UdpRecords kind : {UdpRecords::t64, UdpRecords::t32, UdpRecords::spif}) {
        Bytes bytes;
        append_udp_records(kind, random_events(1, 100, 640, 480, 0, 100), bytes);
        EXPECT_EQ(whole_udp_records(kind, bytes), bytes.size());
        EXPECT_LT(whole_udp_records(kind, std::span(bytes).first(bytes.size() - 1)),
                  bytes.size() - 1);
        const MakeParser make = [&] { return std::make_unique<UdpRecordsParser>(kind, 640, 480); };
        EXPECT_EQ(parse_whole(make, bytes).data.events.size(), 100U);
        expect_same_for_any_split(make, bytes);
        expect_beginnings_for_any_cut(make, bytes);
    }
}

TEST(UdpRecords, TimesOf32BitsGoOnWhereTheyWrap) {
    std::vector<Event> events;
    for (int i = 0; i < 10; ++i)
        events.push_back({from_us((std::int64_t{1} << 32) - 500 + 100 * i), 1, 2, Polarity::on});
    Bytes bytes;
    append_udp_records(UdpRecords::t32, events, bytes);
    const Parsed parsed = parse_whole(
        [] { return std::make_unique<UdpRecordsParser>(UdpRecords::t32, 8, 8); }, bytes);
    EXPECT_TRUE(parsed.data.events == events);
}

TEST(UdpRecords, AnEventOutOfOrderAcrossAWrapShiftsNothing) {
    constexpr std::int64_t kWrap = std::int64_t{1} << 32;
    std::vector<Event> events;
    for (const std::int64_t t : {kWrap - 9, kWrap + 5, kWrap - 1, kWrap - 2, kWrap + 7})
        events.push_back({from_us(t), 1, 2, Polarity::on});
    Bytes bytes;
    append_udp_records(UdpRecords::t32, events, bytes);
    const Parsed parsed = parse_whole(
        [] { return std::make_unique<UdpRecordsParser>(UdpRecords::t32, 8, 8); }, bytes);
    events.erase(events.begin() + 2, events.begin() + 4);
    EXPECT_TRUE(parsed.data.events == events);
    EXPECT_EQ(parsed.damage[DamageReason::time_backwards], 2U);
}

TEST(UdpRecords, StampsThatLieMoveNoTimesBehindThem) {
    std::vector<Event> events;
    for (int i = 0; i < 40; ++i) events.push_back({from_us(1000 * i), 1, 2, Polarity::on});
    std::vector<Event> sent = events;
    sent[10].t = from_us(1'500'000'000);
    sent[20].t = from_us(3'000'000'000);
    for (const UdpRecords kind : {UdpRecords::t32, UdpRecords::spif}) {
        Bytes bytes;
        append_udp_records(kind, sent, bytes);
        const Parsed parsed =
            parse_whole([&] { return std::make_unique<UdpRecordsParser>(kind, 8, 8); }, bytes);
        EXPECT_EQ(parsed.data.events.size(), 38U);
        EXPECT_EQ(parsed.data.events.back(), events.back());
        EXPECT_EQ(parsed.damage[DamageReason::bad_record], 1U);
    }
}

TEST(UdpRecords, TimesOf64BitsHaveNoSign) {
    Bytes bytes;
    append_udp_records(UdpRecords::t64, std::vector<Event>(3, {from_us(-7), 1, 2, Polarity::on}),
                       bytes);
    const Parsed parsed = parse_whole(
        [] { return std::make_unique<UdpRecordsParser>(UdpRecords::t64, 8, 8); }, bytes);
    EXPECT_TRUE(parsed.data.events.empty());
    EXPECT_EQ(parsed.damage[DamageReason::bad_record], 3U);
}

TEST(UdpRecords, ASenderThatBeginsAnewIsFollowed) {
    const auto late = random_events(1, 50, 8, 8, 900'000'000, 100);
    const auto early = random_events(2, 50, 8, 8, 1'000'000, 100);
    Bytes bytes;
    append_udp_records(UdpRecords::t64, late, bytes);
    append_udp_records(UdpRecords::t64, early, bytes);
    const Parsed parsed = parse_whole(
        [] { return std::make_unique<UdpRecordsParser>(UdpRecords::t64, 8, 8); }, bytes);
    EXPECT_EQ(parsed.data.events.size(), 50U + 50U - UdpRecordsParser::kEventsOfAnother + 1);
    EXPECT_EQ(parsed.damage[DamageReason::time_backwards],
              std::uint64_t(UdpRecordsParser::kEventsOfAnother - 1));
    ASSERT_EQ(parsed.data.triggers.size(), 1U);
    EXPECT_EQ(parsed.data.triggers[0].kind, Trigger::Kind::timestamp_reset);
}

/// Events at these times, in ms, read from t64.
Parsed parsed_at(const std::vector<int>& times_ms) {
    std::vector<Event> events;
    for (const int ms : times_ms) events.push_back({from_us(1000 * ms), 1, 2, Polarity::on});
    Bytes bytes;
    append_udp_records(UdpRecords::t64, events, bytes);
    return parse_whole([] { return std::make_unique<UdpRecordsParser>(UdpRecords::t64, 8, 8); },
                       bytes);
}

TEST(UdpRecords, OnlyManyEventsInARowFarInThePastAreAnotherBeginning) {
    constexpr int kNow = 5000, kFewer = UdpRecordsParser::kEventsOfAnother - 1;
    std::vector<int> somewhat(40, kNow - 900), interrupted(kFewer, 10);
    somewhat.insert(somewhat.begin(), {kNow, kNow});
    interrupted.insert(interrupted.begin(), {kNow, kNow});
    interrupted.push_back(kNow);
    interrupted.insert(interrupted.end(), kFewer, 10);
    for (const auto& times : {somewhat, interrupted}) {
        const Parsed parsed = parsed_at(times);
        EXPECT_TRUE(parsed.data.triggers.empty());
        EXPECT_EQ(parsed.data.events.back().t, from_us(1000 * kNow));
    }
}

TEST(UdpRecords, AStrayEventBehindABeginningIsNoOther) {
    std::vector<int> times(UdpRecordsParser::kEventsOfAnother, 3000);
    times.insert(times.begin(), {9000, 9000});
    times.insert(times.end(), {10, 3001, 3002});
    const Parsed parsed = parsed_at(times);
    EXPECT_EQ(parsed.data.triggers.size(), 1U);
    EXPECT_EQ(parsed.data.events.back().t, from_us(3'002'000));
}

TEST(UdpRecords, HalfARecordIsCountedOrLeftBehindAtAGap) {
    for (const UdpRecords kind : {UdpRecords::t64, UdpRecords::t32, UdpRecords::spif}) {
        Bytes bytes;
        append_udp_records(kind, random_events(1, 3, 640, 480, 0, 100), bytes);
        UdpRecordsParser parser{kind, 640, 480};
        Batch batch;
        parser.parse(std::span(bytes).first(5), batch);
        parser.resync();
        parser.parse(bytes, batch);
        ASSERT_FALSE(batch.events.empty());
        EXPECT_EQ(parser.clock(), batch.events.back().t);
        EXPECT_EQ(parser.damaged().total(), 0U);
        parser.parse(std::span(bytes).first(5), batch);
        parser.finish(batch);
        EXPECT_EQ(parser.damaged()[DamageReason::truncated], 1U);
        EXPECT_EQ(batch.events.size(), 3U);
    }
}

TEST(UdpRecords, OfSpifSomeMayHaveATimeAndOthersNone) {
    Bytes bytes;
    const Event timed{from_us(20), 3, 4, Polarity::off};
    for (int i = 0; i < 3; ++i) {
        append_udp_records(UdpRecords::spif, std::vector<Event>{timed}, bytes);
        append_little(bytes, std::uint32_t{0x80000000U | 5U << 16 | 0x8000U | 7U});
    }
    UdpRecordsParser parser{UdpRecords::spif, 640, 480};
    const HostTime begin{std::chrono::seconds(9)};
    parser.arrives(begin);
    parser.arrives(begin + SensorDuration{20});
    Batch batch;
    parser.parse(bytes, batch);
    parser.finish(batch);
    ASSERT_EQ(batch.events.size(), 6U);
    EXPECT_EQ(batch.events[4], timed);
    EXPECT_EQ(batch.events[5], (Event{from_us(20), 5, 7, Polarity::on}));
}

/// 32 bits are 71.6 minutes.
TEST(UdpRecords, TimesBehindASilenceAreWhatTheHostsClockSays) {
    for (const UdpRecords kind : {UdpRecords::t32, UdpRecords::spif})
        for (const int minutes : {1, 30, 36, 60, 75, 80, 110, 300}) {
            UdpRecordsParser parser{kind, 640, 480};
            const std::int64_t begin_us = 2'000'000'000, silent_us = minutes * 60'000'000LL;
            std::vector<Event> expected;
            Batch batch;
            for (int i = 0; i < 40; ++i) {
                const std::int64_t t_us = begin_us + i * 1000 + (i < 20 ? 0 : silent_us);
                const Event event{from_us(t_us), 3, 4, Polarity::off};
                expected.push_back(event);
                Bytes bytes;
                Event sent = event;
                sent.t = from_us(t_us % (std::int64_t{1} << 32));
                append_udp_records(kind, std::vector<Event>{sent}, bytes);
                parser.arrives(HostTime{SensorDuration{t_us + i % 7 * 100}});
                parser.parse(bytes, batch);
            }
            parser.finish(batch);
            EXPECT_EQ(batch.events, expected) << minutes << " min";
            EXPECT_TRUE(batch.triggers.empty());
            EXPECT_EQ(parser.damaged().total(), 0U);
        }
}

TEST(UdpRecords, SpifWithoutTimesHasThatOfTheArrival) {
    UdpRecordsParser parser(UdpRecords::spif, 640, 480);
    Bytes word;
    for (const std::uint32_t value : {0x80000000U | 5U << 16 | 0x8000U | 7U}) {
        for (int i = 0; i < 4; ++i) word.push_back(std::byte(value >> 8 * i & 0xFF));
    }
    Batch batch;
    const HostTime begin{std::chrono::seconds(9)};
    for (const int ms : {0, 10, 25}) {
        parser.arrives(begin + std::chrono::milliseconds(ms));
        parser.parse(word, batch);
    }
    parser.finish(batch);
    ASSERT_EQ(batch.events.size(), 3U);
    EXPECT_EQ(batch.events[2], (Event{from_us(25'000), 5, 7, Polarity::on}));
}

}  // namespace
}  // namespace eventide
