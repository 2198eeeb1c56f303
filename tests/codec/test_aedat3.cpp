// AEDAT 3.1, from packets spelled out.
#include "src/core/error.h"
#include "tests/codec/aedat3_words.h"

namespace eventide::aedat3 {
namespace {

TEST(Aedat3, PolarityEventsAreReadFromTheirWords) {
    const Bytes bytes = packet_header(1, 8, 3) +
                        words({polarity(5, 7, true), 100,  //
                               polarity(6, 7, true, false), 101, polarity(345, 259, false), 102});
    const Parsed parsed = parse_whole(make_parser(), bytes);
    const std::vector<Event> expected{{from_us(100), 5, 7, Polarity::on},
                                      {from_us(102), 345, 259, Polarity::off}};
    EXPECT_EQ(parsed.data.events, expected);  // the invalid one was filtered by the recorder
    EXPECT_EQ(parsed.damage.total(), 0U);
    const Parsed of_3_0 = parse_whole(make_parser(true), bytes);
    EXPECT_EQ(of_3_0.data.events.at(0).y, 252);
    EXPECT_EQ(of_3_0.data.events.at(1).y, 0);
}

TEST(Aedat3, TheOverflowCountsTwoToThe31) {
    const Bytes bytes = packet_header(1, 8, 1, 3) + words({polarity(5, 7, true), 9});
    EXPECT_EQ(to_us(parse_whole(make_parser(), bytes).data.events.at(0).t),
              3 * (std::int64_t(1) << 31) + 9);
}

TEST(Aedat3, SpecialEventsAreTriggers) {
    using Kind = Trigger::Kind;
    const Bytes bytes =
        packet_header(0, 8, 7) + words({special(2), 10, special(3), 11, special(4), 12, special(0),
                                        13, special(7), 14, special(12), 15, special(16), 16});
    const std::vector<Trigger> expected{{from_us(10), Kind::rising, 0},
                                        {from_us(11), Kind::falling, 0},
                                        {from_us(12), Kind::pulse, 0},
                                        {from_us(14), Kind::falling, 1},
                                        {from_us(15), Kind::rising, Trigger::kGenerator},
                                        {from_us(16), Kind::exposure_begin, 0}};
    EXPECT_EQ(parse_whole(make_parser(), bytes).data.triggers, expected);
}

/// Recorders keep what their filters took out.
TEST(Aedat3, RecordsThatAreNotValidAreLeftOut) {
    constexpr std::uint32_t kValid = 1;
    const std::vector<std::uint32_t> imu(7, 0);
    for (const std::uint32_t valid : {0U, kValid}) {
        const Bytes bytes = packet_header(0, 8, 1) + words({special(2) - kValid + valid, 10}) +
                            packet_header(2, 36 + 4, 1) +
                            words({valid | 1U << 1, 9, 9, 9, 9, 1, 1, 3, 4, 7}) +
                            packet_header(3, 36, 1) + words({valid, 20}) + words(imu);
        const Parsed parsed = parse_whole(make_parser(), bytes);
        EXPECT_EQ(parsed.data.triggers.size(), valid);
        EXPECT_EQ(parsed.data.images.size(), valid);
        EXPECT_EQ(parsed.data.imu.size(), valid);
        EXPECT_EQ(parsed.damage.total(), 0U);
    }
}

TEST(Aedat3, StampsHave31Bits) {
    const Bytes bytes = packet_header(1, 8, 4) +
                        words({polarity(1, 1, true), 0x7FFFFFFE, polarity(1, 1, true), 0x7FFFFFFF,
                               polarity(2, 1, true), 0x80000000, polarity(3, 1, true), 0x7FFFFFFF});
    const Parsed parsed = parse_whole(make_parser(), bytes);
    EXPECT_EQ(parsed.data.events.size(), 3U);
    EXPECT_EQ(parsed.damage[DamageReason::bad_record], 1U);
}

/// From the lower left corner on, in a sensor of 260 rows.
TEST(Aedat3, FramesOf30StandOnTheirLastRow) {
    Bytes bytes = packet_header(2, 36 + 12, 1) +
                  words({1U | 1U << 1 | 1U << 4, 100, 200, 120, 181, 2, 3, 7, 10});
    for (std::uint16_t value = 1; value <= 6; ++value) append_little(bytes, value);
    const Parsed parsed = parse_whole(make_parser(true), bytes);
    ASSERT_EQ(parsed.data.images.size(), 1U);
    const ReferenceImage& image = parsed.data.images[0];
    EXPECT_EQ(image.x0, 7);
    EXPECT_EQ(image.y0, 260 - 10 - 3);
    EXPECT_EQ(image.pixels(0, 0), 5);
    EXPECT_EQ(image.pixels(2, 1), 2);
    EXPECT_EQ(image.filter, ColourFilter::none) << "it is said of rows from the top";
}

TEST(Aedat3, RowsOf30AreCountedFromTheSensorsLastAlsoWhereItIsStatedAsSmaller) {
    const auto make = [] {
        Aedat3Header header;
        header.lower_left = true;
        header.source = 1;
        header.stream.height = kHeight;
        return std::make_unique<Aedat3Parser>(header, kWidth, 100);
    };
    Bytes bytes = packet_header(1, 8, 6);
    std::vector<Event> expected;
    for (std::uint16_t row = 0; row < 5; ++row) {
        bytes = bytes + words({polarity(5, 259 - row, true), 100U + row});
        expected.push_back({from_us(100 + row), 5, row, Polarity::on});
    }
    const Parsed parsed = parse_whole(make, bytes + words({polarity(5, 159, true), 105}));
    EXPECT_EQ(parsed.data.events, expected);
    EXPECT_EQ(parsed.damage[DamageReason::out_of_range], 1U);
}

TEST(Aedat3, FramesCarryTheirExposure) {
    // Two by one pixels, RGB, at (3, 4).
    Bytes bytes =
        packet_header(2, 36 + 12, 1) + words({1U | 3U << 1, 100, 200, 120, 181, 2, 1, 3, 4});
    for (std::uint16_t value = 1; value <= 6; ++value) append_little(bytes, value);
    const Parsed parsed = parse_whole(make_parser(), bytes);
    ASSERT_EQ(parsed.data.images.size(), 1U);
    const ReferenceImage& image = parsed.data.images[0];
    EXPECT_EQ(image.exposure_begin, from_us(120));
    EXPECT_EQ(image.exposure_end, from_us(181));
    EXPECT_EQ(image.t, from_us(150));
    EXPECT_EQ(image.x0, 3);
    EXPECT_EQ(image.y0, 4);
    EXPECT_EQ(image.channels, 3);
    const std::vector<std::uint16_t> bgr(image.pixels.values().begin(),
                                         image.pixels.values().end());
    EXPECT_EQ(bgr, (std::vector<std::uint16_t>{3, 2, 1, 6, 5, 4}));
    EXPECT_EQ(parsed.clock, from_us(181));
}

TEST(Aedat3, BehindATimestampResetTimeBeginsAnew) {
    const Bytes bytes = packet_header(1, 8, 1) + words({polarity(1, 1, true), 5000}) +
                        packet_header(0, 8, 1) + words({special(1), 0x7FFFFFFF}) +
                        packet_header(1, 8, 2) +
                        words({polarity(1, 1, true), 10, polarity(1, 1, true), 20});
    const Parsed parsed = parse_whole(make_parser(), bytes);
    ASSERT_EQ(parsed.data.events.size(), 3U);
    EXPECT_EQ(to_us(parsed.data.events[1].t), 10);
    EXPECT_EQ(to_us(parsed.data.events[2].t), 20);
    EXPECT_EQ(parsed.clock, from_us(20));
    ASSERT_EQ(parsed.data.triggers.size(), 1U);
    EXPECT_EQ(parsed.data.triggers[0], (Trigger{from_us(0), Trigger::Kind::timestamp_reset, 0}));
    EXPECT_EQ(parsed.damage.total(), 0U);
}

TEST(Aedat3, OfFilesThatWereJoinedTheSecondMayBeginAtAnEarlierTime) {
    const auto file = [](std::uint32_t begins) {
        return to_bytes("#!AER-DAT3.1\r\n#Format: RAW\r\n#Source 1: DAVIS346\r\n#!END-HEADER\r\n") +
               packet_header(1, 8, 2) +
               words({polarity(1, 1, true), begins, polarity(1, 1, true), begins + 10});
    };
    const Bytes first(file(5000));
    const std::size_t header = read_aedat3_header(first).stream.data_offset;
    for (const std::uint32_t begins : {20U, 6000U}) {
        Bytes bytes = first + file(begins);
        bytes.erase(bytes.begin(), bytes.begin() + std::ptrdiff_t(header));
        const Parsed parsed = parse_whole(make_parser(), bytes);
        ASSERT_EQ(parsed.data.events.size(), 4U);
        EXPECT_EQ(parsed.data.events[2].t, from_us(begins));
        EXPECT_EQ(parsed.data.events[3].t, from_us(begins + 10));
        EXPECT_EQ(parsed.damage.total(), 0U);
        const std::vector<Trigger> reset{{from_us(begins), Trigger::Kind::timestamp_reset, 0}};
        EXPECT_EQ(parsed.data.triggers, begins < 5000 ? reset : std::vector<Trigger>{});
        expect_same_for_any_split(make_parser(), bytes);
    }
}

TEST(Aedat3, OnlyTheLastPossibleStampOfAResetIsNone) {
    const Bytes bytes = packet_header(1, 8, 2) +
                        words({polarity(1, 1, true), 5000, polarity(1, 1, true), 5001}) +
                        packet_header(0, 8, 2) + words({special(1), 6000, special(2), 0x7FFFFFFF});
    const std::vector<Trigger> expected{{from_us(6000), Trigger::Kind::timestamp_reset, 0},
                                        {from_us(0x7FFFFFFF), Trigger::Kind::rising, 0}};
    EXPECT_EQ(parse_whole(make_parser(), bytes).data.triggers, expected);
}

TEST(Aedat3, HeadersAreChecked) {
    const auto read = [](const std::string& text) { return read_aedat3_header(to_bytes(text)); };
    EXPECT_THROW(read("hello"), Error);
    EXPECT_THROW(read("#!AER-DAT3.1\r\n#Format: SerializedTS\r\n#!END-HEADER\r\n"), Error);
    const auto header = read(
        "#!AER-DAT3.1\r\n#Format: RAW\r\n#Source 2: DAVIS240C\r\n"
        "#Start-Time: 2016-01-01 00:00:00 (TZ+0100)\r\n#!END-HEADER\r\n");
    EXPECT_EQ(header.source, 2);
    EXPECT_EQ(header.stream.width, 240);
    EXPECT_FALSE(header.lower_left);
    EXPECT_TRUE(read("#!AER-DAT3.0\r\n").lower_left);
    const auto two = read("#!AER-DAT3.1\r\n#Source 1: DAVIS346\r\n#Source 2:  DVS128 \r\n");
    EXPECT_EQ(two.source, 1);
    EXPECT_EQ(two.stream.sensor_name, "DAVIS346");
    ASSERT_EQ(two.others.size(), 1U);
    EXPECT_EQ(two.others[0].number, 2);
    EXPECT_EQ(two.others[0].name, "DVS128");
}

TEST(Aedat3, OfTwoSourcesTheOneThatIsWantedIsRead) {
    const Bytes two = to_bytes("#!AER-DAT3.1\r\n#Source 1: DAVIS346\r\n#Source 2: DVS128\r\n");
    const Aedat3Header header = read_aedat3_header(two, "2");
    EXPECT_EQ(header.source, 2);
    EXPECT_EQ(header.stream.sensor_name, "DVS128");
    EXPECT_EQ(header.stream.width, 128);
    ASSERT_EQ(header.others.size(), 1U);
    EXPECT_EQ(header.others[0].number, 1);
    EXPECT_THROW(read_aedat3_header(two, "3"), Error);
    EXPECT_THROW(read_aedat3_header(to_bytes("#!AER-DAT3.1\r\n"), "1"), Error);
}

}  // namespace
}  // namespace eventide::aedat3
