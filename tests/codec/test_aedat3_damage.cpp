// AEDAT 3.1: damage, jumps, packets that are none or of others.
#include "tests/codec/aedat3_words.h"

namespace eventide::aedat3 {
namespace {

TEST(Aedat3, AnySplitCutOrDamageIsBorne) {
    const Bytes bytes = written(60);
    expect_same_for_any_split(make_parser(), bytes);
    expect_beginnings_for_any_cut(make_parser(), bytes);
    expect_bears_damage(make_parser(), bytes, kWidth, kHeight, 200);
}

TEST(Aedat3, AQuickLoopAndOneByOneAgreeOnDamagedRecords) {
    Bytes bytes = written(3000);
    std::mt19937 random(8);
    for (int i = 0; i < 200; ++i)
        bytes[28 + random() % (3000 * 8)] ^= std::byte(1U << random() % 8);
    const Parsed whole = parse_whole(make_parser(), bytes);
    EXPECT_GT(whole.damage.total(), 20U);
    expect_orderly(whole, kWidth, kHeight);
    expect_same(whole, parse_in_pieces(make_parser(), bytes, [] { return 8U; }), "one by one");
}

TEST(Aedat3, ALyingHeaderIsLeftAndTheNextPacketFound) {
    const Bytes good = packet_header(1, 8, 1) + words({polarity(5, 7, true), 100});
    for (const auto& [offset, value] :
         std::vector<std::pair<std::size_t, std::uint32_t>>{{0, 0x00010077},
                                                            {4, 0xFFFFFFFF},
                                                            {4, 9},
                                                            {8, 77},
                                                            {12, 0x80000000},
                                                            {20, 0xFFFFFFFF},
                                                            {24, 2}}) {
        Bytes bad = good;
        const Bytes field = words({value});
        std::copy(field.begin(), field.end(), bad.begin() + std::ptrdiff_t(offset));
        const Parsed parsed = parse_whole(make_parser(), bad + good);
        EXPECT_EQ(parsed.data.events.size(), 1U) << offset;
        EXPECT_EQ(parsed.damage[DamageReason::bad_length], 1U) << offset;
    }
}

TEST(Aedat3, OtherTypesArePassedOverAndOtherSourcesCounted) {
    const Bytes good = packet_header(1, 8, 1) + words({polarity(5, 7, true), 100});
    const Bytes point = packet_header(8, 16, 2) + words({1, 2, 3, 4, 5, 6, 7, 8});
    const Parsed passed = parse_whole(make_parser(), point + good);
    EXPECT_EQ(passed.data.events.size(), 1U);
    EXPECT_EQ(passed.damage.total(), 0U);
    const Bytes other = packet_header(1, 8, 1, 0, 2) + words({polarity(5, 7, true), 1});
    const Parsed counted = parse_whole(make_parser(), good + other);
    EXPECT_EQ(counted.data.events.size(), 1U);
    EXPECT_EQ(counted.damage[DamageReason::unknown_word], 1U);
    const auto named = [] {
        Aedat3Header header;
        header.source = 1;
        header.others = {{2, "DAVIS240C"}};
        return std::make_unique<Aedat3Parser>(header, kWidth, kHeight);
    };
    const Parsed left_out = parse_whole(named, good + other + good);
    EXPECT_EQ(left_out.data.events.size(), 2U);
    EXPECT_EQ(left_out.damage.total(), 0U);
}

TEST(Aedat3, WithoutASourceInTheHeaderThatOfTheFirstPacketIsRead) {
    const auto of_source = [](int source) {
        return packet_header(1, 8, 1, 0, source) + words({polarity(5, 7, true), 100});
    };
    const Parsed parsed =
        parse_whole(make_parser(false, std::nullopt), of_source(4) + of_source(5) + of_source(4));
    EXPECT_EQ(parsed.data.events.size(), 2U);
    EXPECT_EQ(parsed.damage[DamageReason::unknown_word], 1U);
}

TEST(Aedat3, APacketWithoutRecordsIsFollowedByAnother) {
    const Bytes good = packet_header(1, 8, 1) + words({polarity(5, 7, true), 100});
    const Parsed parsed =
        parse_whole(make_parser(), good + packet_header(1, 8, 0) + packet_header(8, 16, 0) + good);
    EXPECT_EQ(parsed.data.events.size(), 2U);
    EXPECT_EQ(parsed.damage.total(), 0U);
}

TEST(Aedat3, AfterAJumpBackTimeMayBeEarlier) {
    const auto at = [](std::uint32_t t) {
        return packet_header(1, 8, 2) + words({polarity(5, 7, true), t, polarity(5, 7, true), t});
    };
    const auto parser = make_parser()();
    Batch batch;
    parser->parse(at(5000), batch);
    parser->resync();
    EXPECT_EQ(parser->clock(), std::nullopt);
    parser->parse(at(100), batch);
    EXPECT_EQ(batch.events.size(), 4U);
    EXPECT_EQ(parser->damaged().total(), 0U);
}

/// One before the jump does not make of what comes behind it a stream of its own.
TEST(Aedat3, AResetBeforeAJumpIsOver) {
    const auto at = [](std::uint32_t t) {
        return packet_header(1, 8, 2) + words({polarity(5, 7, true), t, polarity(5, 7, true), t});
    };
    const auto parser = make_parser()();
    Batch batch;
    parser->parse(packet_header(0, 8, 1) + words({special(1), 0x7FFFFFFF}), batch);
    parser->resync();
    parser->parse(at(5000), batch);
    parser->parse(at(100), batch);
    EXPECT_EQ(batch.events.size(), 2U);
    EXPECT_EQ(parser->damaged()[DamageReason::time_backwards], 2U);
}

/// Packets of 40 events, a millisecond apart, with these overflows: damage in it sets all of them
/// off together.
Bytes packets_of_events(const std::vector<std::uint32_t>& overflows) {
    Bytes bytes;
    std::uint32_t stamp = 1000;
    for (const std::uint32_t overflow : overflows) {
        std::vector<std::uint32_t> records;
        for (int i = 0; i < 40; ++i) {
            records.push_back(polarity(5, 7, true));
            records.push_back(stamp++);
        }
        bytes = bytes + packet_header(1, 8, 40, overflow) + words(records);
        stamp += 960;
    }
    return bytes;
}

TEST(Aedat3, AFlippedBitInAPacketsOverflowCostsThatPacket) {
    for (const std::uint32_t bit : {1U, 8U, 1U << 20}) {
        const Bytes bytes = packets_of_events({0, 0, bit, 0, 0});
        const Parsed parsed = parse_whole(make_parser(), bytes);
        EXPECT_EQ(parsed.data.events.size(), 160U) << bit;
        EXPECT_EQ(parsed.damage[DamageReason::bad_record], 40U) << bit;
        EXPECT_EQ(parsed.damage.total(), 40U) << bit;
        EXPECT_EQ(parsed.data.events.back().t, from_us(5039));
        expect_same_for_any_split(make_parser(), bytes);
    }
}

/// Triggers, with the overflow of their packet: their time is the recording's where no events come.
TEST(Aedat3, AFlippedBitInAPacketOfTriggersIsNoSilence) {
    const auto trigger = [](std::uint32_t overflow, std::uint32_t stamp) {
        return packet_header(0, 8, 2, overflow) + words({special(2), stamp, special(3), stamp});
    };
    const auto clock_of = [](const Bytes& bytes) {
        const Parsed parsed = parse_whole(make_parser(), bytes);
        expect_same_for_any_split(make_parser(), bytes);
        return parsed.clock;
    };
    const Bytes events = packets_of_events({0, 0});  // up to 2039 us
    const std::int64_t leap = std::int64_t{1} << 31;
    EXPECT_EQ(clock_of(events + trigger(1, 3000) + trigger(0, 4000)), from_us(4000));
    EXPECT_EQ(clock_of(trigger(0, 500) + trigger(1, 700) + events), from_us(2039));
    EXPECT_EQ(clock_of(events + trigger(1, 3000) + trigger(1, 4000)), from_us(leap + 4000));
    EXPECT_EQ(clock_of(events + trigger(1, 3000)), from_us(leap + 3000))
        << "nothing contradicts it";
}

TEST(Aedat3, AnOverflowThatThePacketsBehindItHaveAsWellIsARealOne) {
    const Parsed parsed = parse_whole(make_parser(), packets_of_events({0, 0, 1, 1}));
    EXPECT_EQ(parsed.data.events.size(), 160U);
    EXPECT_EQ(parsed.damage.total(), 0U);
    const Parsed last = parse_whole(make_parser(), packets_of_events({0, 0, 1}));
    EXPECT_EQ(last.data.events.size(), 120U) << "nothing contradicts the last one";
    EXPECT_EQ(last.damage.total(), 0U);
}

TEST(Aedat3, AFrameThatEndsBeforeItBeginsIsDamage) {
    const Bytes bytes =
        packet_header(2, 36 + 4, 1) + words({1U | 1U << 1, 0, 9, 9, 8, 1, 1, 0, 0, 7});
    EXPECT_EQ(parse_whole(make_parser(), bytes).damage[DamageReason::bad_record], 1U);
}

TEST(Aedat3, AFrameOutsideTheSensorIsDamage) {
    const auto images_at = [](std::uint32_t x, std::uint32_t y, bool lower_left) {
        const Bytes bytes = packet_header(2, 36 + 4, 1) +
                            words({1U | 1U << 1, 0, 9, 0, 9, 2, 1, x, y}) + words({7});
        const Parsed parsed = parse_whole(make_parser(lower_left), bytes);
        EXPECT_EQ(parsed.data.images.size() + parsed.damage[DamageReason::out_of_range], 1U);
        return parsed.data.images.size();
    };
    for (const bool lower_left : {false, true}) {
        EXPECT_EQ(images_at(kWidth - 2, kHeight - 1, lower_left), 1U);
        EXPECT_EQ(images_at(kWidth - 1, 0, lower_left), 0U);
        EXPECT_EQ(images_at(0, kHeight, lower_left), 0U);
        EXPECT_EQ(images_at(5000, 0, lower_left), 0U);
    }
}

TEST(Aedat3, AFrameLargerThanItsRecordIsDamage) {
    for (const auto& [width, height] : {std::pair{50U, 50U}, std::pair{3U, 1U}}) {
        const Bytes bytes =
            packet_header(2, 36 + 4, 1) + words({1U | 1U << 1, 0, 9, 0, 9, width, height, 0, 0, 7});
        const Parsed parsed = parse_whole(make_parser(), bytes);
        EXPECT_TRUE(parsed.data.images.empty());
        EXPECT_EQ(parsed.damage[DamageReason::bad_record], 1U);
    }
}

TEST(Aedat3, AfterAJumpTheNextHeaderIsFound) {
    const Bytes bytes = written(500);
    const Parsed whole = parse_whole(make_parser(), bytes);
    const auto parser = make_parser()();
    parser->resync();
    Batch batch;
    parser->parse(std::span(bytes).subspan(1000), batch);
    parser->finish(batch);
    ASSERT_FALSE(batch.events.empty());
    EXPECT_TRUE(std::equal(batch.events.rbegin(), batch.events.rend(), whole.data.events.rbegin()));
    EXPECT_EQ(parser->damaged().total(), 0U);
}

}  // namespace
}  // namespace eventide::aedat3
