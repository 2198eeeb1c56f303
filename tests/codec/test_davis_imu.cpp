// IMU samples of a DAVIS, from words spelled out and from the writer.
#include "tests/codec/davis_words.h"
#include "tests/support/usb/davis_writer.h"

#include <gtest/gtest.h>

#include <array>
#include <span>

namespace eventide::davis_words {
namespace {

using testing_support::DavisWriter;

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
    EXPECT_EQ(parsed.damaged[DamageReason::bad_record], 1U);
}

TEST(DavisImu, OneThatDoesNotEndBeforeTheNextIsCounted) {
    Words words = imu_words();
    words.pop_back();
    const Words next = imu_words();
    words.insert(words.end(), next.begin() + 1, next.end());
    const auto parsed = parse(words);
    EXPECT_EQ(parsed.data.imu.size(), 1U);
    EXPECT_EQ(parsed.damaged[DamageReason::bad_record], 1U);
}

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

TEST(DavisImu, DoesNotGoOnBehindAResetOrALoss) {
    EXPECT_TRUE(parse_cut_off(imu_words(), 8).imu.empty());
}

TEST(DavisImu, BehindALossItWaitsForATime) {
    const Words words = imu_words();
    const auto without_time = std::span(words).subspan(1);
    DavisParser parser{DavisSensor{}};
    Batch data;
    parser.parse(bytes_of(words), data);
    parser.resync();
    parser.parse(bytes_of({without_time.begin(), without_time.end()}), data);
    EXPECT_EQ(data.imu.size(), 1U);
    parser.parse(bytes_of(words), data);
    EXPECT_EQ(data.imu.size(), 2U);
    EXPECT_EQ(parser.damaged().total(), 0U);
}

TEST(DavisImu, BytesBeyondTheLastAreNoneOfIt) {
    EXPECT_EQ(parse(imu_words(13)).data.imu.size(), 0U);
    Words words = imu_words();
    words.insert(words.end() - 1, {imu_byte(1), imu_byte(2)});
    EXPECT_EQ(parse(words).data.imu, parse(imu_words()).data.imu);
}

TEST(DavisImu, WhatIsNotMeasuredIsZero) {
    Words words{time(50), special(kImuStart), imu_scale(0x60)};  // gyroscope and temperature
    for (const int value : {0, 34, 1, 0, 2, 0, 3, 0}) words.push_back(imu_byte(value));
    words.push_back(special(kImuEnd));
    const auto parsed = parse(words);
    ASSERT_EQ(parsed.data.imu.size(), 1U);
    const ImuSample& sample = parsed.data.imu[0];
    EXPECT_EQ(sample.acceleration_g, (std::array<float, 3>{}));
    EXPECT_NEAR(sample.temperature_c, 35.1, .001);
    EXPECT_EQ(sample.gyro_dps, (std::array<float, 3>{256 * 250 / 32768.F, 512 * 250 / 32768.F,
                                                     768 * 250 / 32768.F}));
}

TEST(DavisImu, ItsTypeSaysItsTemperature) {
    DavisSensor sensor = davis240();
    sensor.imu_type = kImuMpu6500;
    EXPECT_NEAR(parse(imu_words(), sensor).data.imu.at(0).temperature_c, 340 / 333.87 + 21, .001);
}

}  // namespace
}  // namespace eventide::davis_words
