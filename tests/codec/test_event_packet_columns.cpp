// Event packets of ROS drivers: columns as libcaer_driver packs them (libcaer_cmp).
#include "tests/codec/event_packets.h"

#include <gmock/gmock.h>

namespace eventide::event_packets {
namespace {

using testing::ElementsAre;

Parsed parse_compressed(const Words& words) {
    return parse_whole(parser_of(EventPacketEncoding::libcaer_cmp),
                       packet({kStamp, 0}, bytes_of(words)));
}

TEST(EventPacket, CompressedColumnsAreEvents) {
    const Parsed parsed =
        parse_compressed({column(5), row(7, true), low(3), row(8, false), high(1), low(2),
                          column(6), base(16, true), mask(0b10000001), mask(0b1)});
    EXPECT_THAT(parsed.data.events,
                ElementsAre(at(kStampUs, 5, 7, true), at(kStampUs + 3, 5, 8, false),
                            at(kStampUs + 4098, 6, 16, true), at(kStampUs + 4098, 6, 23, true),
                            at(kStampUs + 4098, 6, 24, true)));
    EXPECT_EQ(parsed.damage.total(), 0U);
}

TEST(EventPacket, TimesOfACompressedPacketGoOnThoughItsHighBitsAreMissingOrWrap) {
    // A driver that joins two packets does not say that the high bits changed between them.
    EXPECT_THAT(
        parse_compressed({column(1), low(4000), row(1, true), low(10), row(2, true)}).data.events,
        ElementsAre(at(kStampUs + 4000, 1, 1, true), at(kStampUs + 4106, 1, 2, true)));
    // It has four of the high bits.
    EXPECT_THAT(
        parse_compressed(
            {column(1), high(15), row(1, true), high(0), row(2, true), high(1), row(3, true)})
            .data.events,
        ElementsAre(at(kStampUs + 15 * 4096, 1, 1, true), at(kStampUs + 16 * 4096, 1, 2, true),
                    at(kStampUs + 17 * 4096, 1, 3, true)));
    // All twelve are understood, too.
    EXPECT_THAT(
        parse_compressed({column(1), high(4095), row(1, true), high(0), row(2, true)}).data.events,
        ElementsAre(at(kStampUs + 4095 * 4096, 1, 1, true),
                    at(kStampUs + 4096 * 4096, 1, 2, true)));
}

TEST(EventPacket, ACompressedPacketBeginsWithoutAPlace) {
    const Bytes stream = packet({kStamp, 0}, bytes_of({column(3), row(1, true), base(8, true)})) +
                         packet({kStamp, 0}, bytes_of({row(2, true), column(4), mask(1)}));
    const Parsed parsed = parse_whole(parser_of(EventPacketEncoding::libcaer_cmp), stream);
    EXPECT_THAT(parsed.data.events, ElementsAre(at(kStampUs, 3, 1, true)));
    EXPECT_EQ(parsed.damage[DamageReason::unknown_word], 2U);
}

TEST(EventPacket, CompressedWordsWithoutAPlaceAreDamage) {
    const Parsed parsed =
        parse_compressed({row(1, true), mask(1), column(3), mask(1), 0x6000, row(479, true),
                          row(480, true), column(640), row(1, true)});
    EXPECT_THAT(parsed.data.events, ElementsAre(at(kStampUs, 3, 479, true)));
    EXPECT_EQ(parsed.damage[DamageReason::out_of_range], 2U);
    EXPECT_EQ(parsed.damage[DamageReason::unknown_word], 4U);
}

}  // namespace
}  // namespace eventide::event_packets
