// AEDAT 3.1, from packets spelled out and from the writer.
#include "src/codec/aedat/aedat3.h"

#include "src/codec/aedat/aedat3_records.h"
#include "src/codec/aedat4/aedat4_records.h"
#include "src/core/byte_order.h"
#include "src/core/error.h"
#include "tests/codec/parser_checks.h"

#include <string>

namespace eventide {
namespace {

constexpr int kWidth = 346, kHeight = 260;

MakeParser make_parser(bool lower_left = false, std::optional<int> source = 1) {
    return [=] {
        Aedat3Header header;
        header.lower_left = lower_left;
        header.source = source;
        return std::make_unique<Aedat3Parser>(header, kWidth, kHeight);
    };
}

/// The 28 bytes, field by field.
Bytes packet_header(int type, std::uint32_t record_bytes, std::uint32_t number,
                    std::uint32_t overflow = 0, int source = 1) {
    Bytes out;
    append_little(out, std::int16_t(type));
    append_little(out, std::int16_t(source));
    append_little(out, record_bytes);
    append_little(out, std::uint32_t(type == 2 ? 8 : 4));
    append_little(out, overflow);
    append_little(out, number);
    append_little(out, number);
    append_little(out, number);
    return out;
}

Bytes words(const std::vector<std::uint32_t>& values) {
    Bytes out;
    for (const std::uint32_t value : values) append_little(out, value);
    return out;
}

Bytes operator+(Bytes a, const Bytes& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

std::uint32_t polarity(int x, int y, bool on, bool valid = true) {
    return std::uint32_t(x) << 17 | std::uint32_t(y) << 2 | std::uint32_t(on) << 1 |
           std::uint32_t(valid);
}
std::uint32_t special(int type) {
    return 1U | std::uint32_t(type) << 1;
}

TEST(Aedat3, PolarityEventsAreReadFromTheirWords) {
    const Bytes bytes = packet_header(1, 8, 3) +
                        words({polarity(5, 7, true), 100,  //
                               polarity(6, 7, true, false), 101, polarity(345, 259, false), 102});
    const Parsed parsed = parse_whole(make_parser(), bytes);
    const std::vector<Event> expected{{from_us(100), 5, 7, Polarity::on},
                                      {from_us(102), 345, 259, Polarity::off}};
    EXPECT_EQ(parsed.data.events, expected);  // the invalid one was filtered by the recorder
    EXPECT_EQ(parsed.damage.total(), 0U);
    EXPECT_EQ(parse_whole(make_parser(true), bytes).data.events[0].y, 252);  // 3.0
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
    EXPECT_EQ(parsed.data.triggers[0], (Trigger{from_us(5000), Trigger::Kind::timestamp_reset, 0}));
    EXPECT_EQ(parsed.damage.total(), 0U);
}

TEST(Aedat3, AResetIsReadBackAsItWasWritten) {
    Batch batch;
    batch.events = random_events(1, 5000, kWidth, kHeight, 60'000'000);
    const auto behind = random_events(2, 5000, kWidth, kHeight, 1'000);
    batch.events.insert(batch.events.end(), behind.begin(), behind.end());
    batch.triggers = {{behind.front().t, Trigger::Kind::timestamp_reset, 0}};
    Bytes bytes;
    Aedat3Writer().write(batch, bytes);
    const Parsed parsed = parse_whole(make_parser(), bytes);
    EXPECT_TRUE(parsed.data.events == batch.events);
    EXPECT_TRUE(parsed.data.triggers == batch.triggers);
    EXPECT_EQ(parsed.damage.total(), 0U);
}

Batch everything(unsigned seed, std::int64_t first_us) {
    Batch batch;
    batch.events = random_events(seed, 400, kWidth, kHeight, first_us);
    std::mt19937 random(seed);
    const auto time = [&](int i) { return from_us(first_us + 1000 * i); };
    for (int i = 0; i < 3; ++i) {
        ReferenceImage image;
        image.exposure_begin = time(i);
        image.exposure_end = time(i) + SensorDuration(500);
        image.t = time(i) + SensorDuration(250);
        image.x0 = i;
        image.y0 = 2 * i;
        image.channels = i == 0 ? 1 : i + 2;
        image.pixels = Array2<std::uint16_t>(3 + i, 5 * image.channels);
        for (auto& value : image.pixels.values()) value = std::uint16_t(random());
        batch.images.push_back(image);
    }
    for (int i = 0; i < 6; ++i) {
        ImuSample sample;
        sample.t = time(i);
        for (std::size_t k = 0; k < 3; ++k) {
            sample.acceleration_g[k] = float(random() % 1000) / 7;
            sample.gyro_dps[k] = -float(random() % 1000) / 3;
            if (i >= 4) sample.magnetic_ut[k] = float(k + 1);
        }
        sample.temperature_c = 31.5F;
        batch.imu.push_back(sample);
    }
    for (int kind = 0; kind <= int(Trigger::Kind::other); ++kind)
        for (const int source : {0, 1, 2, 3, 9, 255})
            batch.triggers.push_back({time(kind), Trigger::Kind(kind), std::uint8_t(source)});
    return batch;
}

TEST(Aedat3, TheGeneratorIsTheSameInAedat4AndNoInputIsTakenForIt) {
    const auto in_aedat4 = [](Aedat3Special number) {
        return aedat4_trigger_number(*read_special(1U | std::uint32_t(number) << 1));
    };
    EXPECT_EQ(in_aedat4(Aedat3Special::generator_rising), 4);
    EXPECT_EQ(in_aedat4(Aedat3Special::generator_falling), 5);
    EXPECT_EQ(in_aedat4(Aedat3Special::rising), 1);
    for (const Aedat3Special of_others :
         {Aedat3Special::rising_1, Aedat3Special::falling_1, Aedat3Special::pulse_1,
          Aedat3Special::rising_2, Aedat3Special::falling_2, Aedat3Special::pulse_2})
        EXPECT_EQ(in_aedat4(of_others), -1) << int(of_others);
}

TEST(Aedat3, WhatIsWrittenIsReadBack) {
    constexpr std::int64_t kOverflow = std::int64_t(1) << 31;
    for (const std::int64_t first : {std::int64_t(0), kOverflow - 300, 5 * kOverflow - 9000,
                                     std::int64_t(1'633'953'690'975'950)}) {
        StreamHeader stream;
        stream.width = kWidth;
        stream.height = kHeight;
        stream.sensor_name = "a camera";
        Aedat3Writer writer;
        Bytes bytes;
        writer.begin(stream, bytes);
        const Batch one = everything(1, first), two = everything(2, first + 20000);
        writer.write(one, bytes);
        writer.write(two, bytes);
        writer.finish(bytes);

        const Aedat3Header header = read_aedat3_header(bytes);
        EXPECT_EQ(header.stream.width, kWidth);
        EXPECT_EQ(header.stream.height, kHeight);
        EXPECT_EQ(header.stream.sensor_name, "a camera");
        const Parsed parsed =
            parse_whole([&] { return std::make_unique<Aedat3Parser>(header, kWidth, kHeight); },
                        std::span(bytes).subspan(header.stream.data_offset));
        const auto joined = [](auto a, const auto& b) {
            a.insert(a.end(), b.begin(), b.end());
            return a;
        };
        EXPECT_TRUE(parsed.data.events == joined(one.events, two.events)) << first;
        EXPECT_TRUE(parsed.data.images == joined(one.images, two.images)) << first;
        EXPECT_TRUE(parsed.data.imu == joined(one.imu, two.imu)) << first;
        EXPECT_TRUE(parsed.data.triggers == joined(one.triggers, two.triggers)) << first;
        EXPECT_EQ(parsed.damage.total(), 0U) << first;
    }
}

TEST(Aedat3, WhatTheFormatCannotHoldIsRefused) {
    Bytes bytes;
    Batch negative, wide;
    negative.events = {{from_us(-1), 0, 0, Polarity::on}};
    wide.events = {{from_us(1), 40000, 0, Polarity::on}};
    EXPECT_THROW(Aedat3Writer().write(negative, bytes), Error);
    EXPECT_THROW(Aedat3Writer().write(wide, bytes), Error);
}

Bytes written(std::size_t events) {
    Bytes bytes;
    Batch batch = everything(5, 1'000'000);
    batch.events = random_events(5, events, kWidth, kHeight, 1'000'000);
    Aedat3Writer writer;
    writer.write(batch, bytes);
    batch.events = random_events(6, events, kWidth, kHeight, 1'100'000);
    writer.write(batch, bytes);
    return bytes;
}

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

TEST(Aedat3, AFrameLargerThanItsRecordIsDamage) {
    Bytes bytes = packet_header(2, 36 + 4, 1) + words({1U | 1U << 1, 0, 9, 0, 9, 50, 50, 0, 0, 7});
    const Parsed parsed = parse_whole(make_parser(), bytes);
    EXPECT_TRUE(parsed.data.images.empty());
    EXPECT_EQ(parsed.damage[DamageReason::bad_record], 1U);
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

}  // namespace
}  // namespace eventide
