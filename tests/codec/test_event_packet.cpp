// Event packets of ROS drivers: a word for each event, and what all encodings hold.
#include "tests/codec/event_packets.h"

#include <gmock/gmock.h>

namespace eventide::event_packets {
namespace {

using testing::ElementsAre;

TEST(EventPacket, LibcaersEventsWrapAfter31Bits) {
    const Bytes payload = libcaer_event(1, 2, true, 0x7FFFFFFF) +
                          libcaer_event(9, 9, true, 0x7FFFFFFF, false) +
                          libcaer_event(3, 4, false, 1) + libcaer_event(3, 4, false, -5);
    const Parsed parsed =
        parse_whole(parser_of(EventPacketEncoding::libcaer), packet({kStamp, 0}, payload));
    EXPECT_THAT(parsed.data.events, ElementsAre(at(kStampUs + 0x7FFFFFFF, 1, 2, true),
                                                at(kStampUs + 0x80000001LL, 3, 4, false)));
    EXPECT_EQ(parsed.damage[DamageReason::bad_record], 1U) << "a negative time";
    EXPECT_EQ(parsed.damage.total(), 1U) << "what a filter took out is none";
}

TEST(EventPacket, ATimeOfLibcaersThatGoesBackALittleIsNoWrap) {
    const Bytes payload = libcaer_event(1, 2, true, 2'000'000'000) +
                          libcaer_event(3, 4, true, 1'999'999'999) +
                          libcaer_event(5, 6, true, 2'000'000'001);
    const Parsed parsed =
        parse_whole(parser_of(EventPacketEncoding::libcaer), packet({kStamp, 0}, payload));
    EXPECT_THAT(parsed.data.events, ElementsAre(at(kStampUs + 2'000'000'000, 1, 2, true),
                                                at(kStampUs + 2'000'000'001, 5, 6, true)));
    EXPECT_EQ(parsed.damage[DamageReason::time_backwards], 1U);
}

/// Wraps are of a packet: its time base counts from anew.
TEST(EventPacket, WrapsOfOnePacketAreNotOfTheNext) {
    const Bytes stream =
        packet({kStamp, 0}, libcaer_event(1, 2, true, 0x7FFFFFFF) + libcaer_event(1, 2, true, 1)) +
        packet({kStamp + 3'000'000'000'000ULL, 0}, libcaer_event(3, 4, true, 7));
    EXPECT_EQ(parse_whole(parser_of(EventPacketEncoding::libcaer), stream).data.events.back(),
              at(kStampUs + 3'000'000'007, 3, 4, true));
}

TEST(EventPacket, AfterAGapATimeLikeTheLastIsNoReset) {
    const Bytes stream = packet({kStamp, 0}, libcaer_event(1, 2, true, 9));
    EventPacketParser parser(EventPacketEncoding::libcaer, kWidth, kHeight);
    Batch batch;
    parser.parse(stream, batch);
    parser.resync();
    parser.parse(stream, batch);
    EXPECT_EQ(batch.events.size(), 2U);
    EXPECT_TRUE(batch.triggers.empty());
}

TEST(EventPacket, MonoHasPlacesOfFifteenAndSixteenBits) {
    const MakeParser make = [] {
        return std::make_unique<EventPacketParser>(EventPacketEncoding::mono, 65535, 32768);
    };
    const Parsed parsed =
        parse_whole(make, packet({0, kStamp}, mono_event(65534, 32767, false, 0xFFFFFFFF)));
    EXPECT_THAT(parsed.data.events, ElementsAre(at(kStampUs, 65534, 32767, false)));
}

TEST(EventPacket, AFlippedBitInATimeCostsOnlyTheEventsOfThatTime) {
    const auto of = [](std::int64_t ms, std::int32_t flipped) {
        return packet({std::uint64_t(kStamp + ms * 1'000'000), 0},
                      libcaer_event(1, 2, true, 5) + libcaer_event(3, 4, true, 7 ^ flipped) +
                          libcaer_event(5, 6, true, 9));
    };
    const auto make = parser_of(EventPacketEncoding::libcaer);
    for (const std::int32_t bit : {1 << 17, 1 << 28, 1 << 30}) {
        const Bytes stream = of(0, 0) + of(10, bit) + of(20, 0);
        const Parsed parsed = parse_whole(make, stream);
        EXPECT_EQ(parsed.data.events.size(), 8U) << bit;
        EXPECT_EQ(parsed.damage[DamageReason::bad_record], 1U) << bit;
        EXPECT_EQ(parsed.damage.total(), 1U) << bit;
        expect_same_for_any_split(make, stream);
    }
    constexpr std::int64_t kFarMs = std::int64_t{1} << 30;
    const Bytes stream = of(0, 0) + of(kFarMs, 0) + of(20, 0);
    const Parsed whole_packet = parse_whole(make, stream);
    EXPECT_EQ(whole_packet.data.events.size(), 6U);
    EXPECT_EQ(whole_packet.damage[DamageReason::bad_record], 3U);
    const Parsed silence = parse_whole(make, of(0, 0) + of(kFarMs, 0) + of(kFarMs + 10, 0));
    EXPECT_EQ(silence.data.events.size(), 9U);
    EXPECT_EQ(silence.damage.total(), 0U);
}

TEST(EventPacket, AHeaderThatCannotBeIsDamageAndTheNextIsFound) {
    const Bytes good = packet({kStamp, 0}, libcaer_event(1, 2, true, 9));
    for (const std::size_t field : {4U, 8U, 16U}) {  // length, time base, stamp
        Bytes bad = good;
        for (std::size_t i = 0; i < (field == 4 ? 4U : 8U); ++i) bad[field + i] = std::byte{0xFF};
        const Parsed parsed = parse_whole(parser_of(EventPacketEncoding::libcaer), bad + good);
        EXPECT_EQ(parsed.data.events.size(), 1U) << field;
        EXPECT_EQ(parsed.damage[DamageReason::bad_length], 1U) << field;
        EXPECT_EQ(parsed.damage.total(), 1U) << field;
    }
}

TEST(EventPacket, DamageBetweenPacketsIsCountedEachTime) {
    const Bytes good = packet({kStamp, 0}, libcaer_event(1, 2, true, 9)), bad(5, std::byte{7});
    const Parsed parsed =
        parse_whole(parser_of(EventPacketEncoding::libcaer), bad + good + bad + good + bad);
    EXPECT_EQ(parsed.data.events.size(), 2U);
    EXPECT_EQ(parsed.damage[DamageReason::bad_record], 3U);
    EXPECT_EQ(parsed.damage.total(), 3U);
}

TEST(EventPacket, MonoIsShiftedToItsFirstStampAndStaysThere) {
    const Bytes stream =
        packet({5'000'000, kStamp}, mono_event(1, 2, true, 0) + mono_event(3, 4, false, 7'900)) +
        packet({6'000'000, kStamp + 3'000'000},
               mono_event(5, 6, true, 0));  // its stamp is 2 ms late
    const Parsed parsed = parse_whole(parser_of(EventPacketEncoding::mono), stream);
    EXPECT_THAT(parsed.data.events,
                ElementsAre(at(kStampUs, 1, 2, true), at(kStampUs + 7, 3, 4, false),
                            at(kStampUs + 1000, 5, 6, true)));
}

/// Random packets of each encoding.
Bytes random_stream(EventPacketEncoding encoding, unsigned seed) {
    std::mt19937 random(seed);
    const auto pick = [&](unsigned n) { return unsigned(random() % n); };
    Bytes stream;
    for (unsigned k = 0; k < 20; ++k) {
        const EventPacketHeader header{std::uint64_t(kStamp) + 100'000'000ULL * k,
                                       kStamp + 100'000'000LL * k};
        Bytes payload;
        std::uint32_t t = 0;
        for (unsigned i = pick(40); i > 0; --i) {
            t += pick(50);
            switch (encoding) {
                case EventPacketEncoding::evt3:
                    payload = payload +
                              bytes_of({evt_high(24 * k + t / 4096), evt_low(t % 4096),
                                        evt_row(pick(kHeight)), evt_x(pick(kWidth), pick(2) == 1)});
                    break;
                case EventPacketEncoding::libcaer:
                    payload = payload + libcaer_event(pick(kWidth), pick(kHeight), pick(2) == 1,
                                                      std::int32_t(t));
                    break;
                case EventPacketEncoding::libcaer_cmp:
                    payload = payload + bytes_of({low(t % 4096), column(pick(kWidth)),
                                                  base(pick(kHeight - 8), true), mask(pick(256))});
                    break;
                case EventPacketEncoding::mono:
                    payload =
                        payload + mono_event(pick(kWidth), pick(kHeight), pick(2) == 1, t * 1000);
                    break;
            }
        }
        stream = stream + packet(header, payload);
    }
    return stream;
}

class AnyEventPacket : public testing::TestWithParam<EventPacketEncoding> {};

TEST_P(AnyEventPacket, GivesTheSameForAnySplit) {
    const Bytes stream = random_stream(GetParam(), 1);
    const Parsed parsed = parse_whole(parser_of(GetParam()), stream);
    EXPECT_GT(parsed.data.events.size(), 200U);
    EXPECT_EQ(parsed.damage.total(), 0U);
    expect_orderly(parsed, kWidth, kHeight);
    expect_same_for_any_split(parser_of(GetParam()), stream);
}

TEST_P(AnyEventPacket, BearsDamage) {
    expect_bears_damage(parser_of(GetParam()), random_stream(GetParam(), 2), kWidth, kHeight);
}

TEST_P(AnyEventPacket, CountsAnEndInTheMiddle) {
    Bytes stream =
        random_stream(GetParam(), 3) + packet({std::uint64_t(2 * kStamp), 2 * kStamp}, Bytes(16));
    stream.pop_back();
    EXPECT_GE(parse_whole(parser_of(GetParam()), stream).damage[DamageReason::truncated], 1U);
}

INSTANTIATE_TEST_SUITE_P(, AnyEventPacket,
                         testing::Values(EventPacketEncoding::evt3, EventPacketEncoding::libcaer,
                                         EventPacketEncoding::libcaer_cmp,
                                         EventPacketEncoding::mono));

}  // namespace
}  // namespace eventide::event_packets
