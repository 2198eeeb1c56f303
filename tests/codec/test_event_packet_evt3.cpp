// Event packets of ROS drivers: EVT3, whose times are the sensor's.
#include "tests/codec/event_packets.h"

#include <gmock/gmock.h>

#include <span>
#include <string>

namespace eventide::event_packets {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(EventPacket, Evt3IsShiftedToItsStamp) {
    const Bytes stream =
        packet({0, kStamp}, bytes_of({evt_high(2), evt_low(5), evt_row(7), evt_x(8, true)})) +
        packet({0, kStamp + 9'000},
               bytes_of({evt_low(15), evt_x(9, false)}));  // goes on with row and high time
    const Parsed parsed = parse_whole(parser_of(EventPacketEncoding::evt3), stream);
    EXPECT_THAT(parsed.data.events,
                ElementsAre(at(kStampUs, 8, 7, true), at(kStampUs + 10, 9, 7, false)));
    EXPECT_EQ(parsed.damage.total(), 0U);
}

TEST(EventPacket, TheFirstThingOfAnEvt3PacketIsAtItsStamp) {
    constexpr std::uint16_t kRisingEdge = 0xA001;
    const Words events{evt_low(9), evt_row(7), evt_x(8, true), evt_low(20), evt_x(9, true)};
    Words with_trigger{evt_high(2), evt_low(5), kRisingEdge}, without{evt_high(2)};
    with_trigger.insert(with_trigger.end(), events.begin(), events.end());
    without.insert(without.end(), events.begin(), events.end());
    const auto parse = [](const Words& words) {
        return parse_whole(parser_of(EventPacketEncoding::evt3),
                           packet({0, kStamp}, bytes_of(words)));
    };
    EXPECT_THAT(parse(without).data.events,
                ElementsAre(at(kStampUs, 8, 7, true), at(kStampUs + 11, 9, 7, true)));
    const Parsed parsed = parse(with_trigger);
    EXPECT_THAT(parsed.data.triggers,
                ElementsAre(Trigger{from_us(kStampUs), Trigger::Kind::rising, 0}));
    EXPECT_THAT(parsed.data.events,
                ElementsAre(at(kStampUs + 4, 8, 7, true), at(kStampUs + 15, 9, 7, true)));
    EXPECT_EQ(parsed.clock, from_us(kStampUs + 15));
}

/// A first time is believed with the end of its message, as its stamp dates it; no other is.
TEST(EventPacket, ALeapAtTheEndOfAMessageWaitsForTheNext) {
    const auto message = [](int ms, unsigned high_word, unsigned x) {
        return packet({0, kStamp + ms * 1'000'000LL},
                      bytes_of({evt_high(high_word), evt_low(0), evt_row(1), evt_x(x, true)}));
    };
    const Parsed parsed =
        parse_whole(parser_of(EventPacketEncoding::evt3),
                    message(0, 0, 1) + message(4, 1, 2) + message(8, 900, 3) + message(12, 3, 4));
    EXPECT_THAT(parsed.data.events,
                ElementsAre(at(kStampUs, 1, 1, true), at(kStampUs + 4096, 2, 1, true),
                            at(kStampUs + 3 * 4096, 4, 1, true)));
    EXPECT_EQ(parsed.damage[DamageReason::bad_record], 2U);
}

TEST(EventPacket, AfterAGapTimeGoesOnAndOnlyADriverThatBeganAnewSetsIt) {
    const auto stream = [](std::int64_t stamp_us, unsigned high_word) {
        return packet({0, stamp_us * 1000},
                      bytes_of({evt_high(high_word), evt_low(0), evt_row(1), evt_x(1, true)}));
    };
    EventPacketParser parser(EventPacketEncoding::evt3, kWidth, kHeight);
    Batch batch;
    parser.parse(stream(kStampUs, 0), batch);
    parser.resync();
    parser.parse(stream(kStampUs + 8192 + 3000, 2),
                 batch);  // the stamp is late; the sensor knows better
    EXPECT_EQ(batch.events.back().t, from_us(kStampUs + 8192));
    parser.resync();
    parser.parse(stream(kStampUs + 60'000'000, 3), batch);  // the sensor's clock has wrapped unseen
    EXPECT_EQ(batch.events.back().t, from_us(kStampUs + 60'000'000));
    EXPECT_THAT(batch.triggers, IsEmpty());
    parser.resync();
    parser.parse(stream(kStampUs + 10'000'000, 4), batch);  // the driver's clock was set back
    EXPECT_EQ(batch.events.back().t, from_us(kStampUs + 10'000'000));
    ASSERT_EQ(batch.triggers.size(), 1U);
    EXPECT_EQ(batch.triggers[0].kind, Trigger::Kind::timestamp_reset);
    EXPECT_EQ(parser.damaged().total(), 0U);
}

/// The header of a RAW file among the words, and behind it a message that tells no time for sure:
/// what it said of the clock was lost where the next message began.
TEST(EventPacket, AnEvt3StreamThatBeginsAnewSaysSoHoweverItsMessagesAreCut) {
    const std::string header = "% evt 3.0\n% end\n";
    const auto message = [](const Bytes& words) { return packet({0, kStamp}, words); };
    const auto event_at = [](unsigned high_word, unsigned x) {
        return bytes_of({evt_high(high_word), evt_low(0), evt_row(1), evt_x(x, true)});
    };
    const auto text = std::as_bytes(std::span(header));
    const Bytes stream = message(event_at(900, 1)) + message(event_at(901, 2)) +
                         message(Bytes(text.begin(), text.end()) + bytes_of({evt_high(5)})) +
                         message(event_at(5, 3));
    const Parsed parsed = parse_whole(parser_of(EventPacketEncoding::evt3), stream);
    ASSERT_EQ(parsed.data.events.size(), 3U);
    EXPECT_LT(parsed.data.events[2].t, parsed.data.events[1].t);
    ASSERT_EQ(parsed.data.triggers.size(), 1U);
    EXPECT_EQ(parsed.data.triggers[0].kind, Trigger::Kind::timestamp_reset);
}

TEST(EventPacket, OfAnEvt3PacketThatIsCutByAGapNothingComesWithTheNext) {
    const auto stream = [](unsigned high_word) {
        return packet({0, kStamp}, bytes_of({evt_high(high_word), evt_low(0), evt_row(1),
                                             evt_x(1, true), evt_x(2, true)}));
    };
    const Bytes cut = stream(9);
    EventPacketParser parser(EventPacketEncoding::evt3, kWidth, kHeight);
    Batch batch;
    parser.parse(std::span(cut).first(cut.size() - 2), batch);
    parser.resync();
    parser.parse(stream(1), batch);
    EXPECT_THAT(batch.events, ElementsAre(at(kStampUs, 1, 1, true), at(kStampUs, 2, 1, true)));
}

}  // namespace
}  // namespace eventide::event_packets
