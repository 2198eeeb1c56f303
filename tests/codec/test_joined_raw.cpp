// RAW and DAT files that were joined one behind the other (cat).
#include "src/codec/prophesee/dat.h"
#include "src/codec/prophesee/evt3.h"
#include "src/codec/prophesee/joined_words.h"
#include "tests/codec/evt2_words.h"
#include "tests/codec/evt3_words.h"

#include <gmock/gmock.h>

#include <array>
#include <string>

namespace eventide {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Of a RAW file, before its words.
std::string header_of(const std::string& version) {
    return "% Date 2020-09-14 09:03:25\n% evt " + version + "\n% end\n";
}
const std::string kDatHeader = "% Data file containing CD events.\n% Version 2\n\x0C\x08";

Bytes join(const std::vector<Bytes>& parts) {
    Bytes all;
    for (const Bytes& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
}

/// One event of each of the two files, 1000 us after its beginning.
struct Joined {
    const char* name;
    MakeParser make;
    Bytes first, second;  ///< the second begins earlier
    std::string header;
    std::int64_t first_us, second_us;  ///< of the events
};

Bytes evt2_file(std::uint32_t high) {
    return evt2::to_stream(evt2::Words{evt2::time_high(high), evt2::cd(5, 1, 2, true),
                                       evt2::time_high(high + 1), evt2::cd(5, 3, 2, true)});
}
Bytes evt21_file(std::uint32_t high) {
    return evt2::to_stream(evt2::Pairs{{evt2::time_high(high), 0},
                                       {evt2::cd(5, 1, 2, true), 1},
                                       {evt2::time_high(high + 1), 0},
                                       {evt2::cd(5, 3, 2, true), 1}},
                           evt2::Order::lower_half_first);
}
Bytes evt3_file(unsigned high) {
    Bytes out;
    for (const std::uint16_t w :
         {evt3::time_high(high), evt3::time_low(5), evt3::addr_y(2), evt3::addr_x(1, true),
          evt3::time_high(high + 1), evt3::time_low(5), evt3::addr_x(3, true)})
        append_little(out, w);
    return out;
}
Bytes dat_file(std::uint32_t t) {
    Bytes out;
    for (const std::uint32_t w : {t, 1U | 2U << 14 | 1U << 28, t + 1, 3U | 2U << 14 | 1U << 28})
        append_little(out, w);
    return out;
}

std::vector<Joined> all_formats() {
    return {
        {"evt2", evt2::kMake2, evt2_file(1000), evt2_file(10), header_of("2.0"), 64'005, 645},
        {"evt21", evt2::make21(evt2::Order::lower_half_first), evt21_file(1000), evt21_file(10),
         header_of("2.1"), 64'005, 645},
        {"evt3", [] { return std::make_unique<Evt3Parser>(640, 480); }, evt3_file(1000),
         evt3_file(10), header_of("3.0"), 1000 * 4096 + 5, 10 * 4096 + 5},
        {"dat", [] { return std::make_unique<DatParser>(DatHeader::Record::events_v2, 640, 480); },
         dat_file(5000), dat_file(100), kDatHeader, 5000, 100}};
}

TEST(JoinedRaw, TheNextFileIsReadOnAndBeginsANewStreamWhereItIsEarlier) {
    for (const Joined& files : all_formats()) {
        const Bytes bytes = join({files.first, to_bytes(files.header), files.second});
        const Parsed parsed = parse_whole(files.make, bytes);
        ASSERT_EQ(parsed.data.events.size(), 4U) << files.name;
        EXPECT_EQ(parsed.data.events[0], (Event{from_us(files.first_us), 1, 2, Polarity::on}));
        EXPECT_EQ(parsed.data.events[2], (Event{from_us(files.second_us), 1, 2, Polarity::on}));
        EXPECT_EQ(parsed.damage.total(), 0U) << files.name;
        ASSERT_EQ(parsed.data.triggers.size(), 1U) << files.name;
        EXPECT_EQ(parsed.data.triggers[0].kind, Trigger::Kind::timestamp_reset);
        EXPECT_LE(parsed.data.triggers[0].t, parsed.data.events[2].t);
        EXPECT_LT(parsed.clock, from_us(files.first_us)) << files.name;
        expect_same_for_any_split(files.make, bytes);
    }
}

/// The beginning of a much later file stands before the second.
TEST(JoinedRaw, AFirstTimeThatLiesHidesNoNewStream) {
    const std::vector<Bytes> lies{evt2_file(3000), evt21_file(3000), evt3_file(1500),
                                  dat_file(200'000)};
    constexpr std::array<std::size_t, 4> kOneEvent{8, 16, 8, 8};  // bytes
    const std::vector<Joined> formats = all_formats();
    for (std::size_t i = 0; i < formats.size(); ++i) {
        const Joined& files = formats[i];
        const Bytes lie(lies[i].begin(), lies[i].begin() + std::ptrdiff_t(kOneEvent[i]));
        const Bytes bytes = join({files.first, to_bytes(files.header), lie, files.second});
        const Parsed parsed = parse_whole(files.make, bytes);
        ASSERT_EQ(parsed.data.events.size(), 4U) << files.name;
        EXPECT_EQ(parsed.data.events[2].t, from_us(files.second_us)) << files.name;
        EXPECT_EQ(parsed.data.triggers.size(), 1U) << files.name;
        expect_same_for_any_split(files.make, bytes);
    }
}

TEST(JoinedRaw, AFileWithoutDataBetweenHidesNoNewStream) {
    for (const Joined& files : all_formats()) {
        const Bytes header = to_bytes(files.header);
        const Parsed parsed =
            parse_whole(files.make, join({files.first, header, header, files.second}));
        EXPECT_EQ(parsed.data.events.size(), 4U) << files.name;
        EXPECT_EQ(parsed.data.triggers.size(), 1U) << files.name;
    }
}

TEST(JoinedRaw, ALaterFileGoesOn) {
    for (const Joined& files : all_formats()) {
        const Bytes bytes = join({files.second, to_bytes(files.header), files.first});
        const Parsed parsed = parse_whole(files.make, bytes);
        ASSERT_EQ(parsed.data.events.size(), 4U) << files.name;
        EXPECT_EQ(parsed.data.events[2].t, from_us(files.first_us)) << files.name;
        EXPECT_THAT(parsed.data.triggers, IsEmpty()) << files.name;
    }
}

TEST(JoinedRaw, AFileThatEndsWithinAWordCostsThatWord) {
    for (const Joined& files : all_formats()) {
        Bytes cut = files.first;
        cut.pop_back();
        const Bytes bytes = join({cut, to_bytes(files.header), files.second});
        const Parsed parsed = parse_whole(files.make, bytes);
        EXPECT_EQ(parsed.data.events.size(), 3U) << files.name;
        EXPECT_EQ(parsed.damage[DamageReason::truncated], 1U) << files.name;
        EXPECT_EQ(parsed.damage.total(), 1U) << files.name;
        expect_same_for_any_split(files.make, bytes);
    }
}

TEST(JoinedRaw, AHeaderAtTheEndIsNoData) {
    for (const Joined& files : all_formats())
        for (const std::size_t cut : {0U, 3U, 9U}) {
            const Bytes header = to_bytes(files.header.substr(0, files.header.size() - cut));
            const Bytes bytes = join({files.first, header});
            const Parsed parsed = parse_whole(files.make, bytes);
            EXPECT_EQ(parsed.data.events.size(), 2U) << files.name << cut;
            EXPECT_EQ(parsed.damage.total(), 0U) << files.name << cut;
            expect_same_for_any_split(files.make, bytes);
        }
}

TEST(JoinedRaw, TheTimeThatOurOwnFilesOfEvt3CountFromIsItsOwn) {
    const Parsed parsed =
        parse_whole([] { return std::make_unique<Evt3Parser>(640, 480, 7'000'000); },
                    join({evt3_file(1), to_bytes("% evt 3.0\n% time_base_us 90000000\n% end\n"),
                          evt3_file(1)}));
    ASSERT_EQ(parsed.data.events.size(), 4U);
    EXPECT_EQ(parsed.data.events[0].t, from_us(7'000'000 + 4096 + 5));
    EXPECT_EQ(parsed.data.events[2].t, from_us(90'000'000 + 4096 + 5));
    EXPECT_THAT(parsed.data.triggers, IsEmpty());
    const Parsed back = parse_whole(
        [] { return std::make_unique<Evt3Parser>(640, 480, 90'000'000); },
        join({evt3_file(1), to_bytes("% evt 3.0\n% time_base_us 7000000\n% end\n"), evt3_file(1)}));
    ASSERT_EQ(back.data.events.size(), 4U);
    EXPECT_EQ(back.data.events[2].t, from_us(7'000'000 + 4096 + 5));
    EXPECT_EQ(back.data.triggers.size(), 1U);
}

TEST(JoinedRaw, AFileOfAnotherFormatIsNotReadAndTheOneBehindItIs) {
    const std::vector<Joined> formats = all_formats();
    for (const Joined& files : formats)
        for (const Joined& others : formats) {
            if (files.header == others.header) continue;
            const Bytes bytes = join({files.first, to_bytes(others.header), others.first,
                                      to_bytes(files.header), files.second});
            const Parsed parsed = parse_whole(files.make, bytes);
            const std::string pair = std::string{files.name} + " and " + others.name;
            ASSERT_EQ(parsed.data.events.size(), 4U) << pair;
            EXPECT_EQ(parsed.data.events[2].t, from_us(files.second_us)) << pair;
            EXPECT_EQ(parsed.data.triggers.size(), 1U) << pair;
            EXPECT_GT(parsed.damage[DamageReason::unknown_word], 0U) << pair;
            EXPECT_LE(parsed.damage.total(), parsed.damage[DamageReason::unknown_word] + 1) << pair;
            expect_same_for_any_split(files.make, bytes);
        }
}

TEST(JoinedRaw, AHeaderThatDoesNotSayTheFormatIsOfTheSame) {
    for (const Joined& files : all_formats()) {
        if (files.header == kDatHeader) continue;
        const Bytes bytes =
            join({files.first, to_bytes("% Date 2014-02-28 13:37:42\n"), files.second});
        EXPECT_EQ(parse_whole(files.make, bytes).data.events.size(), 4U) << files.name;
    }
    const Bytes unknown =
        join({evt3_file(10), to_bytes("% format HISTO3D\n% end\n"), evt3_file(1000)});
    EXPECT_EQ(parse_whole(all_formats()[2].make, unknown).data.events.size(), 2U);
}

TEST(JoinedRaw, TheHalvesOfEvt21ComeInTheOrderOfTheirOwnFile) {
    const Bytes swapped = evt2::to_stream(
        evt2::Pairs{
            {evt2::time_high(2000), 0}, {evt2::cd(5, 7, 2, true), 1}, {evt2::time_high(2001), 0}},
        evt2::Order::upper_half_first);
    const Bytes bytes =
        join({evt21_file(1000), to_bytes("% format EVT21;endianness=legacy\n% end\n"), swapped,
              to_bytes(header_of("2.1")), evt21_file(3000)});
    const Parsed parsed = parse_whole(evt2::make21(evt2::Order::lower_half_first), bytes);
    ASSERT_EQ(parsed.data.events.size(), 5U);
    EXPECT_EQ(parsed.data.events[2], (Event{from_us(2000 * 64 + 5), 7, 2, Polarity::on}));
    EXPECT_EQ(parsed.damage.total(), 0U);
}

TEST(JoinedRaw, RecordsOfDatAreOfTheKindThatTheirOwnFileSays) {
    const Bytes triggers = dat_file(7000);
    const Bytes bytes =
        join({dat_file(5000), to_bytes("% Data file containing triggers.\n\x0E\x08"), triggers,
              to_bytes(kDatHeader), dat_file(9000)});
    const auto make = all_formats()[3].make;
    const Parsed parsed = parse_whole(make, bytes);
    EXPECT_EQ(parsed.data.events.size(), 4U);
    ASSERT_EQ(parsed.data.triggers.size(), 2U);
    EXPECT_EQ(parsed.data.triggers[0].t, from_us(7000));
    EXPECT_EQ(parsed.damage.total(), 0U);
    expect_same_for_any_split(make, bytes);
    const Parsed unknown = parse_whole(
        make, join({dat_file(5000), to_bytes("% Version 2\n\x18\x08"), dat_file(7000)}));
    EXPECT_EQ(unknown.data.events.size(), 2U);
    EXPECT_EQ(unknown.damage[DamageReason::unknown_word], 2U);
}

/// The next file's times have nothing to do with the range of those before.
TEST(JoinedRaw, AFallToTheNextFileIsNoWrap) {
    const Parsed parsed = parse_whole(
        evt2::kMake2, join({evt2_file(0x0FFFFF00), to_bytes(header_of("2.0")), evt2_file(10)}));
    ASSERT_EQ(parsed.data.events.size(), 4U);
    EXPECT_EQ(parsed.data.events[2].t, from_us(10 * 64 + 5));
}

std::string text_of(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// What comes out of words of a byte each, headers in brackets.
std::string told_by(const std::string& text, std::size_t behind_lines = 0) {
    JoinedWords<1> words{behind_lines};
    std::string told;
    const auto use = [&](auto bytes) { told += text_of(bytes); };
    const auto joint = [&](auto lines) { told += "[" + text_of(lines) + "]"; };
    const Bytes bytes = to_bytes(text);
    words.feed(bytes, use, joint);
    words.finish(use, joint);
    return told;
}

TEST(JoinedRaw, WhatIsNoHeaderIsData) {
    for (const char* data : {"%", "% ", "% D", "%% Dat", "% Dat% Dat", "% evto\n", "% evt", "abc"})
        EXPECT_EQ(told_by(data), data);
}

TEST(JoinedRaw, AHeaderEndsWhereItsLinesDo) {
    EXPECT_EQ(told_by("ab% evt 3.0\nc"), "ab[% evt 3.0\n]c");
    EXPECT_EQ(told_by("% % evt 3.0\n% x\r\n%d"), "% [% evt 3.0\n% x\r\n]%d");
    EXPECT_EQ(told_by("% evt 3.0\n% end\n% x\n"), "[% evt 3.0\n% end\n]% x\n");
    EXPECT_EQ(told_by("% evt 3.0\n% end\r\n% x\n"), "[% evt 3.0\n% end\r\n]% x\n");
    EXPECT_EQ(told_by("% evt 3.0\n% a\x01 b\n"), "[% evt 3.0\n]% a\x01 b\n");
    EXPECT_EQ(told_by("% Date x\n\x0C\x08 a", 2), "[% Date x\n\x0C\x08] a");
    EXPECT_EQ(told_by("% Date x\n\x0C", 2), "[% Date x\n\x0C]");
    EXPECT_EQ(told_by("% Date x\n% end\n%%a", 2), "[% Date x\n% end\n%%]a");
    EXPECT_EQ(told_by("a% evt 3.0\nb% evt 3.0\nc"), "a[% evt 3.0\n]b[% evt 3.0\n]c");
}

}  // namespace
}  // namespace eventide
