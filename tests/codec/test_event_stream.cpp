// Event Stream against words spelled out from its description.
#include "src/codec/event_stream.h"
#include "src/core/error.h"
#include "tests/codec/parser_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace eventide {
namespace {

using Kind = EventStreamHeader::Kind;

Bytes bytes_of(std::initializer_list<int> values) {
    Bytes bytes;
    for (const int value : values) bytes.push_back(std::byte(value));
    return bytes;
}

MakeParser parser_of(Kind kind) {
    return [kind] { return std::make_unique<EventStreamParser>(kind, 640, 480); };
}

Bytes header_of(int version, int kind) {
    Bytes header = to_bytes("Event Stream");
    for (const int value : {version, 0, 0, kind, 0x80, 0x02, 0xE0, 0x01})
        header.push_back(std::byte(value));
    return header;
}

TEST(EventStream, HeaderSaysSizeAndKind) {
    const auto header = read_event_stream_header(header_of(2, 1));
    EXPECT_EQ(header.kind, Kind::dvs);
    EXPECT_EQ(header.stream.width, 640);
    EXPECT_EQ(header.stream.height, 480);
    EXPECT_EQ(header.stream.data_offset, 20U);
    EXPECT_EQ(read_event_stream_header(header_of(2, 2)).kind, Kind::atis);
}

TEST(EventStream, OtherVersionsAndKindsAreRefusedByName) {
    const auto refusal = [](const Bytes& bytes) -> std::string {
        try {
            read_event_stream_header(bytes);
        } catch (const Error& error) {
            return error.what();
        }
        return "nothing was refused";
    };
    EXPECT_THAT(refusal(header_of(1, 1)), testing::HasSubstr("version 1.0"));
    EXPECT_THAT(refusal(header_of(2, 0)), testing::HasSubstr("generic events"));
    EXPECT_THAT(refusal(header_of(2, 4)), testing::HasSubstr("colour events"));
    Bytes cut = header_of(2, 1);
    cut.resize(17);
    EXPECT_THAT(refusal(cut), testing::HasSubstr("cut short"));
}

TEST(EventStream, DvsEventsHaveSevenBitsOfTimeAndRowsFromBelow) {
    const Parsed parsed = parse_whole(parser_of(Kind::dvs), bytes_of({
                                                                3 << 1 | 1,
                                                                0x01,
                                                                0x02,
                                                                0x00,
                                                                0x00,
                                                                0xFF,
                                                                0xFE,
                                                                0xFF,  // 254 us
                                                                1 << 1,
                                                                0x05,
                                                                0x00,
                                                                0xDF,
                                                                0x01,
                                                            }));
    const std::vector<Event> expected{{from_us(3), 513, 479, Polarity::on},
                                      {from_us(258), 5, 0, Polarity::off}};
    EXPECT_TRUE(parsed.data.events == expected);
    EXPECT_EQ(parsed.damage.total(), 0U);
    EXPECT_EQ(parsed.clock, from_us(258));
}

TEST(EventStream, AtisChangesAreEventsAndExposuresAreNone) {
    const Parsed parsed =
        parse_whole(parser_of(Kind::atis), bytes_of({
                                               5 << 2 | 2, 1, 0, 2, 0,  // on
                                               0xFF,                    // 189 us
                                               1 << 2 | 1, 1, 0, 2, 0,  // exposure
                                               0xFC,                    // nothing
                                               2 << 2, 7, 0, 2, 0,      // off
                                           }));
    const std::vector<Event> expected{{from_us(5), 1, 477, Polarity::on},
                                      {from_us(197), 7, 477, Polarity::off}};
    EXPECT_TRUE(parsed.data.events == expected);
}

TEST(EventStream, DamageIsCountedByReason) {
    const Parsed parsed = parse_whole(parser_of(Kind::dvs), bytes_of({2, 0x80, 0x02, 0, 0,  // x 640
                                                                      2, 0, 0, 0xE0, 0x01,  // y 480
                                                                      2, 1, 0}));
    EXPECT_EQ(parsed.damage[DamageReason::out_of_range], 2U);
    EXPECT_EQ(parsed.damage[DamageReason::truncated], 1U);
}

TEST(EventStream, BearsSplitsCutsAndDamage) {
    Bytes bytes;
    std::int64_t now = 0;
    for (const Event& event : random_events(1, 400, 640, 480, 0, 400)) {
        for (now += 0x7F; now <= to_us(event.t); now += 0x7F) bytes.push_back(std::byte{0xFF});
        now -= 0x7F;
        bytes.push_back(std::byte((to_us(event.t) - now) << 1 | int(event.polarity)));
        now = to_us(event.t);
        for (const int value : {event.x & 0xFF, event.x >> 8, event.y & 0xFF, event.y >> 8})
            bytes.push_back(std::byte(value));
    }
    EXPECT_EQ(parse_whole(parser_of(Kind::dvs), bytes).data.events.size(), 400U);
    for (const Kind kind : {Kind::dvs, Kind::atis}) {
        expect_same_for_any_split(parser_of(kind), bytes);
        expect_beginnings_for_any_cut(parser_of(kind), bytes);
        expect_bears_damage(parser_of(kind), bytes, 640, 480);
    }
}

}  // namespace
}  // namespace eventide
