// DAT, record by record.
#include "src/codec/prophesee/dat.h"

#include "src/core/byte_order.h"
#include "src/core/error.h"
#include "tests/codec/data_files.h"
#include "tests/codec/parser_checks.h"

namespace eventide {
namespace {

constexpr int kWidth = 304, kHeight = 240;
using Record = DatHeader::Record;

MakeParser make(Record record = Record::events_v2) {
    return [record] { return std::make_unique<DatParser>(record, kWidth, kHeight); };
}

Bytes to_stream(const std::vector<std::uint32_t>& words) {
    Bytes out;
    for (const std::uint32_t w : words) append_little(out, w);
    return out;
}
std::uint32_t place(unsigned x, unsigned y, bool on) {
    return x | y << 14 | unsigned(on) << 28;
}
Event event(std::int64_t t, int x, int y, bool on) {
    return {from_us(t), std::uint16_t(x), std::uint16_t(y), Polarity(on)};
}

TEST(Dat, VersionTwoHasWidePlaces) {
    const Parsed parsed =
        parse_whole(make(), to_stream({7, place(303, 239, true), 9, place(0, 1, false), 9,
                                       place(304, 1, false), 8, place(1, 1, true)}));
    const std::vector<Event> expected{event(7, 303, 239, true), event(9, 0, 1, false)};
    EXPECT_TRUE(parsed.data.events == expected);
    EXPECT_EQ(parsed.damage[DamageReason::out_of_range], 1U);
    EXPECT_EQ(parsed.damage[DamageReason::time_backwards], 1U);
}

TEST(Dat, WithoutASizePlacesAreAsLargeAsTheirBits) {
    const MakeParser any_size = [] { return std::make_unique<DatParser>(Record::events_v2); };
    const Parsed parsed = parse_whole(any_size, to_stream({7, place(16383, 16383, true)}));
    EXPECT_EQ(parsed.data.events, std::vector{event(7, 16383, 16383, true)});
}

TEST(Dat, VersionOneHasNarrowOnes) {
    const Parsed parsed =
        parse_whole(make(Record::events_v1), to_stream({7, 303U | 239U << 9 | 1U << 17, 8, 5}));
    const std::vector<Event> expected{event(7, 303, 239, true), event(8, 5, 0, false)};
    EXPECT_TRUE(parsed.data.events == expected);
}

TEST(Dat, TriggersHaveAnInputAndAnEdge) {
    const Parsed parsed =
        parse_whole(make(Record::triggers), to_stream({7, 6U << 8 | 1U, 8, 6U << 8}));
    const std::vector<Trigger> expected{{from_us(7), Trigger::Kind::rising, 6},
                                        {from_us(8), Trigger::Kind::falling, 6}};
    EXPECT_TRUE(parsed.data.triggers == expected);
}

/// Inputs may rise at one time, the first two of a file among them.
TEST(Dat, AFirstTriggerThatTheNextContradictsIsDamage) {
    const Parsed parsed = parse_whole(
        make(Record::triggers), to_stream({9'000'000, 6U << 8 | 1U, 7, 6U << 8 | 1U, 8, 6U << 8}));
    const std::vector<Trigger> expected{{from_us(7), Trigger::Kind::rising, 6},
                                        {from_us(8), Trigger::Kind::falling, 6}};
    EXPECT_TRUE(parsed.data.triggers == expected);
    EXPECT_EQ(parsed.damage[DamageReason::bad_record], 1U);
}

TEST(Dat, ATriggerThatWaitsWhereALossBeginsIsLost) {
    for (const unsigned behind : {5U, 8U}) {
        DatParser parser(Record::triggers);
        Batch batch;
        parser.parse(to_stream({7, 1}), batch);
        parser.resync();
        parser.parse(to_stream({behind, 1, behind + 1, 0}), batch);
        const std::vector<Trigger> expected{{from_us(behind), Trigger::Kind::rising, 0},
                                            {from_us(behind + 1), Trigger::Kind::falling, 0}};
        EXPECT_EQ(batch.triggers, expected);
    }
}

TEST(Dat, TriggersOfOneTimeAreNoneBeforeEachOther) {
    DatParser parser(Record::triggers);
    Batch batch;
    parser.parse(to_stream({7, 30U << 8 | 1U, 7, 31U << 8 | 1U, 9, 30U << 8, 9, 31U << 8}), batch);
    const std::vector<Trigger> expected{{from_us(7), Trigger::Kind::rising, 30},
                                        {from_us(7), Trigger::Kind::rising, 31},
                                        {from_us(9), Trigger::Kind::falling, 30},
                                        {from_us(9), Trigger::Kind::falling, 31}};
    EXPECT_EQ(batch.triggers, expected) << "and none waits for another";
    parser.parse(to_stream({8, 1U}), batch);
    EXPECT_EQ(parser.damaged()[DamageReason::time_backwards], 1U);
    parser.resync();
    parser.parse(to_stream({2, 1U, 3, 0U}), batch);
    EXPECT_EQ(batch.triggers.size(), 6U) << "after a jump back";
    EXPECT_EQ(parser.damaged().total(), 1U);
}

TEST(Dat, TimeWrapsAndLeapsAreConfirmed) {
    const Parsed wrapped =
        parse_whole(make(), to_stream({0xFFFFFFFF, place(1, 1, true), 4, place(2, 1, true)}));
    const std::vector<Event> expected{event(0xFFFFFFFF, 1, 1, true),
                                      event((std::int64_t(1) << 32) + 4, 2, 1, true)};
    EXPECT_TRUE(wrapped.data.events == expected);

    const Parsed flipped = parse_whole(
        make(),
        to_stream({5, place(1, 1, true), 0x40000006, place(2, 1, true), 7, place(3, 1, true)}));
    const std::vector<Event> without{event(5, 1, 1, true), event(7, 3, 1, true)};
    EXPECT_TRUE(flipped.data.events == without);
    EXPECT_EQ(flipped.damage[DamageReason::bad_record], 1U);

    const Parsed leapt =
        parse_whole(make(), to_stream({4, place(0, 1, true), 5, place(1, 1, true), 0x40000006,
                                       place(2, 1, true), 0x40000007, place(3, 1, true)}));
    EXPECT_EQ(leapt.data.events.size(), 4U);
    EXPECT_EQ(leapt.damage.total(), 0U);
}

TEST(Dat, AnEventOutOfOrderAcrossAWrapShiftsNothing) {
    const Parsed parsed = parse_whole(
        make(),
        to_stream({0xFFFFFFF0, place(1, 1, true), 4, place(2, 1, true), 0xFFFFFFFF,
                   place(3, 1, true), 0xFFFFFFFE, place(4, 1, true), 9, place(5, 1, true)}));
    const std::vector<Event> expected{event(0xFFFFFFF0, 1, 1, true),
                                      event((std::int64_t(1) << 32) + 4, 2, 1, true),
                                      event((std::int64_t(1) << 32) + 9, 5, 1, true)};
    EXPECT_TRUE(parsed.data.events == expected);
    EXPECT_EQ(parsed.damage[DamageReason::time_backwards], 2U);
}

TEST(Dat, AFlippedBitOfAnyStampCostsATenthOfASecond) {
    for (const std::int64_t first : {std::int64_t(0x5A5A5A5A), (std::int64_t(1) << 32) - 300'000}) {
        std::vector<Event> events;
        std::vector<std::uint32_t> words;
        for (unsigned i = 0; i < 60; ++i) {
            events.push_back(event(first + 10'000 * i, int(i), 1, true));
            words.push_back(std::uint32_t(first + 10'000 * i));
            words.push_back(place(i, 1, true));
        }
        EXPECT_TRUE(parse_whole(make(), to_stream(words)).data.events == events);
        for (std::size_t at = 0; at < words.size(); at += 2)
            for (unsigned bit = 0; bit < 32; ++bit) {
                std::vector<std::uint32_t> flipped = words;
                flipped[at] ^= 1U << bit;
                expect_most_events_kept(parse_whole(make(), to_stream(flipped)), events, 11,
                                        std::to_string(at) + ", bit " + std::to_string(bit));
                const Parsed triggers = parse_whole(make(Record::triggers), to_stream(flipped));
                EXPECT_GE(triggers.data.triggers.size(), 60U - 11U) << at << ", bit " << bit;
            }
    }
}

TEST(Dat, SplitsCutsAndFlippedBitsAreBorne) {
    std::vector<std::uint32_t> words;
    for (const Event& e : random_events(1, 500, kWidth, kHeight)) {
        words.push_back(std::uint32_t(to_us(e.t)));
        words.push_back(place(e.x, e.y, e.polarity == Polarity::on));
    }
    const Bytes bytes = to_stream(words);
    EXPECT_EQ(parse_whole(make(), bytes).damage.total(), 0U);
    expect_same_for_any_split(make(), bytes);
    expect_beginnings_for_any_cut(make(), std::span(bytes).first(400));
    expect_bears_damage(make(), bytes, kWidth, kHeight);
    expect_same_for_any_split(make(Record::triggers), bytes);
}

TEST(Dat, ARealRecordingGivesItsNumbers) {
    const Bytes file = read_data_file("ncars_4407_td.dat");
    if (file.empty()) GTEST_SKIP() << "no shared/data/formats";
    const DatHeader header = read_dat_header(file);
    const auto make_parser = [&] {
        return std::make_unique<DatParser>(header.record, header.stream.width,
                                           header.stream.height);
    };
    const Parsed parsed =
        parse_whole(make_parser, std::span(file).subspan(header.stream.data_offset));
    const auto& events = parsed.data.events;
    ASSERT_EQ(events.size(), 4407U);
    EXPECT_EQ(count_on(events), 1671U);
    EXPECT_EQ(to_us(events.front().t), 0);
    EXPECT_EQ(to_us(events.back().t), 99937);
    EXPECT_EQ(parsed.damage.total(), 0U);
}

TEST(Dat, HeadersTellVersionAndRecord) {
    const auto header_of = [](const std::string& text, int type) {
        Bytes bytes = to_bytes(text);
        bytes.push_back(std::byte(type));
        bytes.push_back(std::byte{8});
        return read_dat_header(bytes);
    };
    const DatHeader header = header_of("% Width 304\n% Height 240\n% Version 2\n% end\n", 12);
    EXPECT_EQ(header.record, Record::events_v2);
    EXPECT_EQ(header.stream.width, 304);
    EXPECT_EQ(header.stream.height, 240);
    EXPECT_EQ(header_of("% Version 2\n", 14).record, Record::triggers);
    EXPECT_EQ(header_of("% Date now\n", 0).record, Record::events_v1);
    EXPECT_EQ(header_of("% Version 2\n", 0).record, Record::events_v2);
    EXPECT_THROW(header_of("% Version 2\n", 3), Error);
    EXPECT_THROW(header_of("", 12), Error);
    EXPECT_THROW(header_of("% evt 3.0\n", 12), Error);
}

}  // namespace
}  // namespace eventide
