// AEDAT 2.0: events, IMU samples and triggers from their words, and headers.
#include "src/core/error.h"
#include "tests/codec/aedat2_words.h"

#include <gmock/gmock.h>

namespace eventide::aedat2 {
namespace {

TEST(Aedat2, DavisEventsHaveTheirOriginAtTheTopLeft) {
    const Parsed parsed = parse_whole(
        davis(), join({dvs(0, 0, true, 10), dvs(239, 179, false, 11), dvs(5, 170, true, 11)}));
    const std::vector<Event> expected{{from_us(10), 0, 0, Polarity::on},
                                      {from_us(11), 239, 179, Polarity::off},
                                      {from_us(11), 5, 170, Polarity::on}};
    EXPECT_EQ(parsed.data.events, expected);
    EXPECT_EQ(parsed.damage.total(), 0U);
    // X = 0 in the address is the right border, Y = 0 the lowest row.
    const Parsed zero = parse_whole(davis(), record(0, 1));
    EXPECT_EQ(zero.data.events.at(0), (Event{from_us(1), 239, 179, Polarity::off}));
}

/// The upper left part of the sensor, for events and images alike.
TEST(Aedat2, OfASensorStatedAsSmallerWhatLiesOutsideIsLeftOut) {
    const MakeParser make = [] {
        return std::make_unique<Aedat2Parser>(Aedat2Sensor::davis, kWidth, kHeight, false, 2, 1);
    };
    const Parsed parsed = parse_whole(
        make, join({dvs(1, 0, true, 10), dvs(2, 0, true, 11), dvs(1, 1, true, 12),
                    dvs(239, 179, true, 13), aps(false, 0, 0, 600, 20), aps(false, 1, 0, 600, 21),
                    aps(false, 2, 0, 600, 22), aps(true, 0, 0, 500, 30), aps(true, 1, 0, 400, 31),
                    aps(true, 2, 0, 300, 32)}));
    EXPECT_EQ(parsed.data.events, (std::vector{Event{from_us(10), 1, 0, Polarity::on}}));
    ASSERT_EQ(parsed.data.images.size(), 1U);
    EXPECT_EQ(parsed.data.images[0].pixels.width(), 2);
    EXPECT_EQ(parsed.data.images[0].pixels(0, 1), of_16_bits(200));
    EXPECT_EQ(parsed.damage[DamageReason::out_of_range], 3U + 2U);
    EXPECT_EQ(parsed.damage.total(), 3U + 2U);
}

TEST(Aedat2, Dvs128ZeroIsOnUnlessStatedOtherwise) {
    // y 3 from below, x 5 from the right.
    const Bytes bytes = record(3U << 8 | 5U << 1 | 0, 7);
    EXPECT_EQ(parse_whole(dvs128(), bytes).data.events.at(0),
              (Event{from_us(7), 122, 124, Polarity::on}));
    EXPECT_EQ(parse_whole(dvs128(true), bytes).data.events.at(0).polarity, Polarity::off);
}

TEST(Aedat2, EdgesOnTheExternalInputAreTriggers) {
    const Parsed parsed = parse_whole(davis(), join({external(5), dvs(1, 1, true, 6)}));
    ASSERT_EQ(parsed.data.triggers.size(), 1U);
    EXPECT_EQ(parsed.data.triggers[0], (Trigger{from_us(5), Trigger::Kind::pulse, 0}));
    EXPECT_EQ(parse_whole(dvs128(), record(0x8000, 5)).data.triggers.size(), 1U);
}

TEST(Aedat2, SevenWordsMakeAnImuSample) {
    const Parsed parsed = parse_whole(
        davis(), join({imu(0, 8192, 20), imu(1, -4096, 20), imu(2, 0, 20), imu(3, 340, 20),
                       imu(4, 655, 20), imu(5, -655, 20), imu(6, 131, 20)}));
    ASSERT_EQ(parsed.data.imu.size(), 1U);
    const ImuSample& sample = parsed.data.imu[0];
    EXPECT_EQ(sample.t, from_us(20));
    EXPECT_EQ(sample.acceleration_g, (std::array<float, 3>{1, -0.5, 0}));
    EXPECT_EQ(sample.gyro_dps, (std::array<float, 3>{10, -10, 2}));
    EXPECT_FLOAT_EQ(sample.temperature_c, 36);
    EXPECT_EQ(parsed.damage.total(), 0U);
}

TEST(Aedat2, ImuSamplesThatMissWordsAreCounted) {
    const Parsed parsed =
        parse_whole(davis(), join({imu(0, 1, 20), imu(1, 1, 20), imu(6, 1, 20),  // holes
                                   imu(0, 1, 30), imu(1, 1, 30), imu(0, 1, 40),  // begun anew
                                   imu(1, 1, 40), imu(2, 1, 40), imu(4, 1, 40), imu(5, 1, 40),
                                   imu(6, 1, 40),  // without temperature
                                   imu(7, 1, 50), imu(0, 1, 60)}));
    EXPECT_EQ(parsed.data.imu.size(), 1U);
    EXPECT_EQ(parsed.damage[DamageReason::bad_record], 2U);
    EXPECT_EQ(parsed.damage[DamageReason::unknown_word], 1U);
    EXPECT_EQ(parsed.damage[DamageReason::truncated], 1U);
}

/// A bit of everything, in time order.
Bytes mixture() {
    std::vector<Bytes> parts;
    for (const Event& e : random_events(3, 40, 5, 4, 50))
        parts.push_back(record(std::uint32_t(3 - e.y) << 22 | std::uint32_t(4 - e.x) << 12 |
                                   std::uint32_t(e.polarity == Polarity::on) << 11,
                               to_us(e.t)));
    parts.push_back(global_frame(0, 0, 5, 4, 2100));
    for (unsigned i = 0; i < 7; ++i) parts.push_back(imu(i, 100, 2200));
    parts.push_back(external(2300));
    for (const Event& e : random_events(4, 40, 5, 4, 2400))
        parts.push_back(
            record(std::uint32_t(3 - e.y) << 22 | std::uint32_t(4 - e.x) << 12, to_us(e.t)));
    return join(parts);
}

TEST(Aedat2, AnySplitCutOrDamageIsBorne) {
    const Bytes bytes = mixture();
    EXPECT_EQ(parse_whole(davis(5, 4), bytes).damage.total(), 0U);
    expect_same_for_any_split(davis(5, 4), bytes);
    expect_beginnings_for_any_cut(davis(5, 4), bytes);
    expect_bears_damage(davis(5, 4), bytes, 5, 4);
    expect_bears_damage(dvs128(), bytes, 128, 128);
}

std::string jaer_header(const std::string& chip) {
    return "#!AER-DAT2.0\r\n# This is a raw AE data file - do not edit\r\n# AEChip: " + chip +
           "\r\n#End Of ASCII Header\r\n";
}

TEST(Aedat2, AnImuSampleIsOfOneTimeAndBeginsAnewWhereItsWordsDo) {
    const auto words = [](std::initializer_list<unsigned> measures, std::int64_t t) {
        std::vector<Bytes> all;
        for (const unsigned measure : measures) all.push_back(imu(measure, 1, t));
        return join(all);
    };
    const Parsed torn = parse_whole(davis(), join({words({0, 1, 2}, 20), words({3, 4, 5, 6}, 30)}));
    EXPECT_TRUE(torn.data.imu.empty());
    EXPECT_EQ(torn.damage[DamageReason::bad_record], 2U);
    const Parsed anew =
        parse_whole(davis(), join({words({0, 1}, 40), words({0, 1, 2, 3, 4, 5, 6}, 40)}));
    EXPECT_EQ(anew.data.imu.size(), 1U);
    EXPECT_EQ(anew.damage[DamageReason::bad_record], 1U);
}

TEST(Aedat2, AfterAJumpNothingHalfReadGoesOnAndTimeMayBeEarlier) {
    const auto parser = davis(2, 1)();
    Batch batch;
    parser->parse(join({record(1U << 12, 5000), imu(0, 1, 5000), imu(1, 1, 5000), imu(2, 1, 5000),
                        aps(false, 0, 0, 600, 5001, 1), aps(false, 1, 0, 600, 5002, 1)}),
                  batch);
    parser->resync();
    EXPECT_EQ(parser->clock(), std::nullopt);
    parser->parse(
        join({record(1U << 12, 100), imu(3, 1, 100), imu(4, 1, 100), imu(5, 1, 100), imu(6, 1, 100),
              aps(true, 0, 0, 500, 101, 1), aps(true, 1, 0, 500, 102, 1)}),
        batch);
    EXPECT_EQ(batch.events.size(), 2U);
    EXPECT_TRUE(batch.imu.empty());
    EXPECT_TRUE(batch.images.empty());
    const auto chip = dvs128()();
    chip->parse(record(2, 5000), batch);
    chip->resync();
    chip->parse(record(2, 100), batch);
    EXPECT_EQ(batch.events.size(), 4U);
}

TEST(Aedat2, AnAddressOfMoreThanSixteenBitsIsNoneOfADvs128) {
    EXPECT_EQ(parse_whole(dvs128(), record(0x10002, 5)).damage[DamageReason::unknown_word], 1U);
}

TEST(Aedat2, EventsOfOneTimeAreAllTaken) {
    for (const MakeParser& make : {davis(), dvs128()})
        EXPECT_EQ(
            parse_whole(make, join({record(2, 7), record(4, 7), record(6, 7)})).data.events.size(),
            3U);
}

TEST(Aedat2, TheChipIsReadFromTheHeader) {
    const auto size_of = [](const std::string& chip) {
        const StreamHeader h = read_aedat2_header(to_bytes(jaer_header(chip))).stream;
        return std::pair{h.width, h.height};
    };
    EXPECT_EQ(size_of("eu.seebetter.ini.chips.davis.DAVIS240C"), (std::pair{240, 180}));
    EXPECT_EQ(size_of("eu.seebetter.ini.chips.davis.Davis346B"), (std::pair{346, 260}));
    EXPECT_EQ(size_of("ch.unizh.ini.jaer.chip.retina.DVS128"), (std::pair{128, 128}));
    EXPECT_THROW(size_of("some.other.Chip"), Error);
    const auto sensor_of = [](const std::string& chip) {
        return read_aedat2_header(to_bytes(jaer_header(chip))).sensor;
    };
    EXPECT_EQ(sensor_of("eu.seebetter.ini.chips.davis.DAVIS240B"), Aedat2Sensor::davis240);
    EXPECT_EQ(sensor_of("eu.seebetter.ini.chips.sbret10.SBret10"), Aedat2Sensor::davis240);
    EXPECT_EQ(sensor_of("eu.seebetter.ini.chips.davis.Davis346red"), Aedat2Sensor::davis);
}

TEST(Aedat2, DataThatBeginWithAHashAreNoHeader) {
    const std::string head = "#!AER-DAT2.0\r\n";
    Bytes bytes = to_bytes(head);
    const Bytes data = join({record(0x23202020, 5), record(0x0A0A0A0A, 6)});
    bytes.insert(bytes.end(), data.begin(), data.end());
    EXPECT_EQ(read_aedat2_header(bytes, 346, 260).stream.data_offset, head.size());
}

/// Two files one behind the other; the first ends within a record.
Bytes joined_files(const std::string& second_header, std::int64_t second_begins) {
    Bytes first = join({dvs(1, 1, true, 1000), dvs(2, 1, true, 1001), dvs(3, 1, true, 1002)});
    first.pop_back();
    return join({first, to_bytes(second_header), dvs(4, 1, true, second_begins),
                 dvs(5, 1, true, second_begins + 7)});
}

TEST(Aedat2, OfFilesThatWereJoinedTheHeadersAreNoRecords) {
    constexpr const char* kLines = "#!AER-DAT2.0\r\n# AEChip: Davis240C\r\n";
    const std::string ended = std::string(kLines) + "#End Of ASCII Header\r\n";
    for (const std::string& header : {std::string(kLines), ended})
        for (const std::int64_t begins : {2000, 5}) {
            const Bytes bytes = joined_files(header, begins);
            const Parsed parsed = parse_whole(davis(), bytes);
            const std::int64_t from = std::max<std::int64_t>(begins, 1001);
            EXPECT_THAT(parsed.data.events,
                        testing::ElementsAre(Event{from_us(1000), 1, 1, Polarity::on},
                                             Event{from_us(1001), 2, 1, Polarity::on},
                                             Event{from_us(from), 4, 1, Polarity::on},
                                             Event{from_us(from + 7), 5, 1, Polarity::on}));
            EXPECT_EQ(parsed.data.triggers.size(), begins < 1001 ? 1U : 0U);
            EXPECT_EQ(parsed.damage[DamageReason::truncated], 1U);
            EXPECT_EQ(parsed.damage.total(), 1U);
            expect_same_for_any_split(davis(), bytes);
        }
}

TEST(Aedat2, WhatLooksLikeTheBeginningOfAHeaderIsARecord) {
    // The address and the first bytes of the time spell "#!AER".
    const Bytes bytes = join({dvs(1, 1, true, 0x52000000), to_bytes("#!AER"), Bytes(3),
                              to_bytes("##!A"), to_bytes("R-DA")});
    for (std::size_t n = 0; n <= bytes.size(); ++n) {
        const Parsed parsed = parse_whole(davis(), std::span(bytes).first(n));
        EXPECT_EQ(parsed.damage[DamageReason::truncated], n % 8 == 0 ? 0U : 1U) << n;
        EXPECT_EQ(parsed.data.events.size() + parsed.damage.total(), (n + 7) / 8) << n;
    }
    expect_same_for_any_split(davis(), bytes);
}

TEST(Aedat2, NoImageIsMadeOfTheEndOfOneFileAndTheBeginningOfTheNext) {
    const Bytes frame = global_frame(0, 0, 3, 4, 100);
    const Bytes resets(frame.begin(), frame.begin() + std::ptrdiff_t(frame.size() / 2));
    const Bytes signals(frame.begin() + std::ptrdiff_t(frame.size() / 2), frame.end());
    const Parsed parsed =
        parse_whole(davis(3, 4), join({resets, to_bytes("#!AER-DAT2.0\r\n"), signals}));
    EXPECT_TRUE(parsed.data.images.empty());
    EXPECT_EQ(parsed.damage[DamageReason::truncated], 2U);
}

TEST(Aedat2, WithoutAChipShortAddressesMeanADvs128) {
    Bytes bytes = to_bytes("#!AER-DAT2.0\r\n");
    const Bytes data = join({record(0x7F01, 5), record(0x0102, 6)});
    bytes.insert(bytes.end(), data.begin(), data.end());
    EXPECT_EQ(read_aedat2_header(bytes).sensor, Aedat2Sensor::dvs128);
    const Bytes wide = record(0x12345678, 7);
    bytes.insert(bytes.end(), wide.begin(), wide.end());
    EXPECT_THROW(read_aedat2_header(bytes), Error);
    EXPECT_EQ(read_aedat2_header(bytes, 240, 180).sensor, Aedat2Sensor::davis240);
    EXPECT_EQ(read_aedat2_header(bytes, 346, 260).sensor, Aedat2Sensor::davis);
}

}  // namespace
}  // namespace eventide::aedat2
