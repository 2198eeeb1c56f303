// DAVIS words, spelled out, and read(write(x)) = x.
#include "src/codec/inivation/davis.h"
#include "tests/support/usb/davis_sensors.h"
#include "tests/support/usb/davis_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace eventide {
namespace {

using testing::ElementsAre;
using testing_support::davis240;
using testing_support::DavisWriter;

// The vocabulary of docs/protocols.md A.9.
constexpr std::uint16_t time(int low15) {
    return std::uint16_t(0x8000 | low15);
}
constexpr std::uint16_t special(int what) {
    return std::uint16_t(what);
}
constexpr std::uint16_t addr_y(int y) {
    return std::uint16_t(0x1000 | y);
}
constexpr std::uint16_t off_x(int x) {
    return std::uint16_t(0x2000 | x);
}
constexpr std::uint16_t on_x(int x) {
    return std::uint16_t(0x3000 | x);
}
constexpr std::uint16_t adc(int level) {
    return std::uint16_t(0x4000 | level);
}
constexpr std::uint16_t imu_byte(int value) {
    return std::uint16_t(0x5000 | value);
}
constexpr std::uint16_t roi_high(int value) {
    return std::uint16_t(0x5100 | value);
}
constexpr std::uint16_t roi_low(int value) {
    return std::uint16_t(0x5200 | value);
}
constexpr std::uint16_t imu_scale(int bits) {
    return std::uint16_t(0x5300 | bits);
}
constexpr std::uint16_t exposure(int bits) {
    return std::uint16_t(0x6000 | bits);
}
constexpr std::uint16_t wrap(int times) {
    return std::uint16_t(0x7000 | times);
}
constexpr int kTimestampReset = 1, kImuStart = 5, kImuEnd = 7, kGlobalFrame = 8, kFrameEnd = 10,
              kResetColumn = 11, kSignalColumn = 12, kColumnEnd = 13, kExposureStart = 14,
              kExposureEnd = 15;

using Words = std::vector<std::uint16_t>;

std::vector<std::byte> bytes_of(const Words& words) {
    std::vector<std::byte> bytes;
    for (const std::uint16_t w : words) {
        bytes.push_back(std::byte(w & 0xFF));
        bytes.push_back(std::byte(w >> 8));
    }
    return bytes;
}

struct Parsed {
    Batch data;
    Damage damaged;
    DavisStreamFacts facts;
};

Parsed parse_bytes(std::span<const std::byte> bytes, const DavisSensor& sensor,
                   std::size_t piece = SIZE_MAX) {
    DavisParser parser{sensor};
    Parsed parsed;
    for (std::size_t at = 0; at < bytes.size(); at += std::min(piece, bytes.size() - at))
        parser.parse(bytes.subspan(at, std::min(piece, bytes.size() - at)), parsed.data);
    parser.finish(parsed.data);
    parsed.damaged = parser.damaged();
    parsed.facts = parser.facts();
    return parsed;
}
Parsed parse(const Words& words, const DavisSensor& sensor = davis240()) {
    return parse_bytes(bytes_of(words), sensor);
}

Event event(std::int64_t t, int x, int y, Polarity polarity) {
    return {from_us(t), std::uint16_t(x), std::uint16_t(y), polarity};
}

TEST(DavisWords, RowThenColumnsMakeEvents) {
    const auto parsed = parse({time(7), addr_y(3), on_x(5), off_x(6), time(9), addr_y(4), on_x(5)});
    EXPECT_THAT(parsed.data.events,
                ElementsAre(event(7, 5, 3, Polarity::on), event(7, 6, 3, Polarity::off),
                            event(9, 5, 4, Polarity::on)));
    EXPECT_EQ(parsed.damaged.total(), 0U);
}

TEST(DavisWords, SwappedSensorsAreTurnedUpright) {
    const DavisSensor davis346;  // columns 260, rows 346
    const auto parsed = parse({time(1), addr_y(345), on_x(259)}, davis346);
    EXPECT_THAT(parsed.data.events, ElementsAre(event(1, 345, 259, Polarity::on)));
    EXPECT_EQ(davis346.width(), 346);
}

TEST(DavisWords, WrapsAddMultiplesOf32768) {
    const auto parsed = parse(
        {time(32767), addr_y(0), on_x(0), wrap(1), time(0), on_x(1), wrap(3), time(2), on_x(2)});
    EXPECT_EQ(to_us(parsed.data.events[1].t), 32768);
    EXPECT_EQ(to_us(parsed.data.events[2].t), 4 * 32768 + 2);
}

TEST(DavisWords, TimeGoesOnThroughATimestampReset) {
    const auto parsed = parse({time(100), special(kTimestampReset), time(5), addr_y(0), on_x(0)});
    EXPECT_EQ(to_us(parsed.data.events.at(0).t), 105);
    ASSERT_EQ(parsed.data.triggers.size(), 1U);
    EXPECT_EQ(parsed.data.triggers[0].kind, Trigger::Kind::timestamp_reset);
    EXPECT_EQ(parsed.facts.timestamp_resets, 1U);
}

TEST(DavisWords, WhatMakesNoSenseIsCountedByReason) {
    const auto parsed = parse({time(10), addr_y(180), on_x(0), addr_y(0), on_x(240), time(5),
                               addr_y(1), on_x(1), special(99)});
    EXPECT_EQ(parsed.damaged[DamageReason::out_of_range], 2U);
    EXPECT_EQ(parsed.damaged[DamageReason::time_backwards], 1U);
    EXPECT_EQ(parsed.damaged[DamageReason::unknown_word], 1U);
    EXPECT_THAT(parsed.data.events, ElementsAre(event(10, 1, 1, Polarity::on)));
}

TEST(DavisWords, EdgesSayWhetherTheyAreOfTheInputOrTheGenerator) {
    const auto parsed =
        parse({time(10), special(2), special(3), special(4), special(16), special(17)});
    using Kind = Trigger::Kind;
    constexpr std::uint8_t kGenerator = Trigger::kGenerator;
    const std::vector<Trigger> expected{{from_us(10), Kind::falling, 0},
                                        {from_us(10), Kind::rising, 0},
                                        {from_us(10), Kind::pulse, 0},
                                        {from_us(10), Kind::falling, kGenerator},
                                        {from_us(10), Kind::rising, kGenerator}};
    EXPECT_EQ(parsed.data.triggers, expected);
}

TEST(DavisWords, NothingIsGuessedAfterALoss) {
    DavisParser parser{davis240()};
    Batch data;
    parser.parse(bytes_of({time(10), addr_y(2), on_x(1)}), data);
    parser.resync();
    EXPECT_FALSE(parser.clock());
    parser.parse(bytes_of({on_x(2), time(11), on_x(3), addr_y(4), on_x(4)}), data);
    EXPECT_THAT(data.events,
                ElementsAre(event(10, 1, 2, Polarity::on), event(11, 4, 4, Polarity::on)));
}

TEST(DavisWords, LostWrapsAreFoundFromTheHostsClock) {
    DavisParser parser{davis240()};
    Batch data;
    parser.arrives(HostTime{});
    parser.parse(bytes_of({time(1000)}), data);
    parser.resync();
    parser.arrives(HostTime{SensorDuration{3 * 32768 + 200}});  // 200 us later than the last one
    parser.parse(bytes_of({time(1000), addr_y(0), on_x(0)}), data);
    EXPECT_EQ(to_us(data.events.at(0).t), 3 * 32768 + 1000);
}

/// A frame of 2 x 2 pixels at (10, 20). `brighter` is added to the samples of the first.
Words small_frame(bool with_last_column_end = true, int brighter = 0) {
    Words words{time(100), special(kGlobalFrame)};
    for (const int corner : {10, 20, 11, 21}) {
        words.push_back(roi_high(corner >> 8));
        words.push_back(roi_low(corner & 255));
    }
    const auto column = [&](int kind, int a, int b, bool end = true) {
        words.insert(words.end(), {special(kind), adc(a), adc(b)});
        if (end) words.push_back(special(kColumnEnd));
    };
    // DAVIS240 sends half of what the samples mean: 500 means 1000.
    column(kResetColumn, 500 + brighter, 500);
    column(kResetColumn, 500, 100);
    words.insert(words.end(),
                 {time(110), special(kExposureStart), time(210), special(kExposureEnd)});
    column(kSignalColumn, 450 + brighter, 400);
    column(kSignalColumn, 0, 90, with_last_column_end);
    words.insert(words.end(), {exposure(10), exposure(1), special(kFrameEnd)});
    return words;
}

std::uint16_t wide(int ten_bits) {
    return std::uint16_t((ten_bits << 6) | (ten_bits >> 4));
}

TEST(DavisFrame, IsResetMinusSignalWithItsTimesAndPlace) {
    const auto parsed = parse(small_frame());
    ASSERT_EQ(parsed.data.images.size(), 1U);
    const ReferenceImage& image = parsed.data.images[0];
    EXPECT_EQ(image.x0, 10);
    EXPECT_EQ(image.y0, 20);
    EXPECT_EQ(to_us(image.exposure_begin), 110);
    EXPECT_EQ(to_us(image.exposure_end), 210);
    EXPECT_EQ(to_us(image.t), 160);
    EXPECT_EQ(image.pixels(0, 0), wide(100));
    EXPECT_EQ(image.pixels(1, 0), wide(200));
    EXPECT_EQ(image.pixels(0, 1), 65535);  // signal 0: over-exposed
    EXPECT_EQ(image.pixels(1, 1), 65535);  // reset level too low: over-exposed before it began
    EXPECT_EQ(parsed.facts.exposure_us, (1U * 1024 + 10) / 30);
}

TEST(DavisFrame, ADavis240sDoubledSamplesAreSubtractedBeforeTheyAreLimited) {
    const auto parsed = parse(small_frame(true, 100));  // reset 1200, signal 1100
    ASSERT_EQ(parsed.data.images.size(), 1U);
    EXPECT_EQ(parsed.data.images[0].pixels(0, 0), wide(100));
}

TEST(DavisFrame, MissingColumnEndLosesTheFrameAndIsCounted) {
    const auto parsed = parse(small_frame(false));
    EXPECT_TRUE(parsed.data.images.empty());
    EXPECT_EQ(parsed.facts.frames_incomplete, 1U);
}

TEST(DavisFrame, StartingInTheMiddleIsIgnored) {
    auto words = small_frame();
    words.erase(words.begin(), words.begin() + 12);
    EXPECT_TRUE(parse(words).data.images.empty());
}

Words imu_words(int bytes = 14) {
    Words words{time(50), special(kImuStart), imu_scale(0xE0 | (1 << 2) | 1)};
    const int values[7] = {8192, -8192, 4096, 340, 655, 0, -655};
    for (int i = 0; i < bytes; ++i) {
        const auto bits = std::uint16_t(values[i / 2]);
        words.push_back(imu_byte(i % 2 == 0 ? bits >> 8 : bits & 255));
    }
    words.push_back(special(kImuEnd));
    return words;
}

TEST(DavisImu, ComesInUnits) {
    const auto parsed = parse(imu_words());
    ASSERT_EQ(parsed.data.imu.size(), 1U);
    const ImuSample& sample = parsed.data.imu[0];
    EXPECT_EQ(sample.acceleration_g, (std::array<float, 3>{1, -1, .5}));
    EXPECT_NEAR(sample.gyro_dps[0], 10, .01);
    EXPECT_NEAR(sample.gyro_dps[2], -10, .01);
    EXPECT_EQ(sample.temperature_c, 36);
}

TEST(DavisImu, TruncatedIsCountedAndLeftOut) {
    const auto parsed = parse(imu_words(13));
    EXPECT_TRUE(parsed.data.imu.empty());
    EXPECT_EQ(parsed.facts.imu_incomplete, 1U);
}

/// Random events, images, IMU samples and triggers, as a camera would see them.
Batch random_scene(const DavisSensor& sensor, unsigned seed) {
    std::mt19937 rng{seed};
    const auto below = [&](int n) { return int(rng() % unsigned(n)); };
    Batch batch;
    std::int64_t t = 0;
    for (int i = 0; i < 5000; ++i) {
        t += below(8) == 0 ? below(100000) : below(3);
        batch.events.push_back(
            event(t, below(sensor.width()), below(sensor.height()), Polarity(below(2))));
        if (i % 500 == 250)
            batch.triggers.push_back(
                {from_us(t), below(2) ? Trigger::Kind::rising : Trigger::Kind::falling, 0});
    }
    for (int i = 0; i < 3; ++i) {
        ReferenceImage image;
        image.exposure_begin = from_us(t / 4 * (i + 1));
        image.exposure_end = image.exposure_begin + SensorDuration{5000};
        image.t = image.exposure_begin + SensorDuration{2500};
        image.x0 = 3;
        image.y0 = 1;
        image.pixels = Array2<std::uint16_t>{7, 11};
        for (auto& pixel : image.pixels.values()) pixel = wide(2 * below(511));
        batch.images.push_back(image);
    }
    return batch;
}

class DavisRoundTrip : public testing::TestWithParam<int> {};

/// All eight orientations, swapped or not, flipped or not: what is written upright is read upright.
TEST_P(DavisRoundTrip, ReadOfWriteIsTheSameForAnyOrientationAndAnySplit) {
    DavisSensor sensor;
    sensor.dvs_swapped = sensor.aps_swapped = (GetParam() & 4) != 0;
    sensor.aps_flip_x = (GetParam() & 2) != 0;
    sensor.aps_flip_y = (GetParam() & 1) != 0;
    const Batch scene = random_scene(sensor, unsigned(GetParam()));
    std::vector<std::byte> bytes;
    DavisWriter writer{sensor};
    DavisWriter::timestamp_reset(bytes);
    writer.write(scene, bytes);
    for (const std::size_t piece :
         {std::size_t{1}, std::size_t{7}, std::size_t{4096}, bytes.size()}) {
        const auto parsed = parse_bytes(bytes, sensor, piece);
        EXPECT_EQ(parsed.data.events, scene.events);
        EXPECT_EQ(parsed.data.images, scene.images);
        EXPECT_EQ(parsed.data.triggers.size(), scene.triggers.size() + 1);  // and the reset
        EXPECT_EQ(parsed.damaged.total(), 0U);
    }
}

INSTANTIATE_TEST_SUITE_P(Orientations, DavisRoundTrip, testing::Range(0, 8));

TEST(DavisImu, ReadOfWriteIsTheSameWithinAStepOfTheConverter) {
    const DavisSensor sensor;
    ImuSample sample{from_us(40000), {.1F, -2.F, 3.9F}, {-100.F, 0.F, 499.F}, {}, 41.F};
    Batch batch;
    batch.imu.push_back(sample);
    std::vector<std::byte> bytes;
    DavisWriter writer{sensor};
    writer.write(batch, bytes);
    const auto parsed = parse_bytes(bytes, sensor);
    ASSERT_EQ(parsed.data.imu.size(), 1U);
    EXPECT_EQ(parsed.data.imu[0].t, sample.t);
    for (std::size_t a = 0; a < 3; ++a) {
        EXPECT_NEAR(parsed.data.imu[0].acceleration_g[a], sample.acceleration_g[a], 1.0 / 8192);
        EXPECT_NEAR(parsed.data.imu[0].gyro_dps[a], sample.gyro_dps[a], 1.0 / 65);
    }
    EXPECT_NEAR(parsed.data.imu[0].temperature_c, sample.temperature_c, 1.0 / 300);
}

TEST(DavisWords, RandomBytesNeverHarm) {
    std::mt19937 rng{1};
    for (int round = 0; round < 200; ++round) {
        std::vector<std::byte> bytes(1 + rng() % 5000);
        for (auto& b : bytes) b = std::byte(rng());
        const auto parsed = parse_bytes(bytes, DavisSensor{}, 1 + rng() % 700);
        for (std::size_t i = 1; i < parsed.data.events.size(); ++i)
            ASSERT_LE(parsed.data.events[i - 1].t, parsed.data.events[i].t);
    }
}

}  // namespace
}  // namespace eventide
