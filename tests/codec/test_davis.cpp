// DAVIS words, spelled out, and read(write(x)) = x.
#include "tests/codec/davis_words.h"
#include "tests/support/usb/davis_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace eventide::davis_words {
namespace {

using testing::ElementsAre;
using testing_support::DavisWriter;

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
}

TEST(DavisWords, WhatMakesNoSenseIsCountedByReason) {
    const auto parsed = parse({time(10), addr_y(180), on_x(0), addr_y(0), on_x(240), time(5),
                               addr_y(1), on_x(1), special(99), 0x5400, exposure(0x400)});
    EXPECT_EQ(parsed.damaged[DamageReason::out_of_range], 2U);
    EXPECT_EQ(parsed.damaged[DamageReason::time_backwards], 1U);
    EXPECT_EQ(parsed.damaged[DamageReason::unknown_word], 3U);
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
    parser.parse(bytes_of({on_x(2), special(3), time(11), on_x(3), addr_y(4), on_x(4)}), data);
    EXPECT_TRUE(data.triggers.empty());
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
}  // namespace eventide::davis_words
