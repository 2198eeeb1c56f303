// What a DVXplorer is told: the settings file, and the registers it becomes.
#include "drivers/usb/dvxplorer_settings.h"
#include "tests/drivers/usb_sessions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

namespace eventide::test {
namespace {

using davis::Register;
using davis::Write;
using testing::HasSubstr;

std::map<Register, std::uint32_t> registers_of(const DvxplorerSettings& settings,
                                               const DvxplorerFeatures& features = {}) {
    std::map<Register, std::uint32_t> registers;
    for (const Write& write : configuration(settings, {}, features))
        registers[write.at] = write.value;
    return registers;
}

constexpr Register chip(int address) {
    return {davis::chip, std::uint16_t(address)};
}

TEST(DvxplorerSettings, ShippedFileSaysTheDefaults) {
    EXPECT_EQ(configuration(load_dvxplorer_settings(shipped("dvxplorer.toml")), {}, {}),
              configuration(DvxplorerSettings{}, {}, {}));
}

TEST(DvxplorerSettings, EveryKeyIsTaken) {
    const auto settings = load_dvxplorer_settings(written(R"(
contrast_on = 3
contrast_off = 12
roi = [8, 16, 320, 240]
polarity = "on"
subsample = 4
activity_decision = true
activity_positive = 1000
activity_negative = 5
imu = false
accel_range_g = 8
gyro_range_dps = 125
detect_pulses = false
detect_edges = true
transfers = 4
transfer_kib = 128
early_packet_delay_us = 500
verify = false
)"));
    EXPECT_EQ(settings.contrast_on, 3);
    EXPECT_EQ(settings.roi->width, 320);
    EXPECT_EQ(settings.transfers.bytes, 128U << 10);
    EXPECT_FALSE(settings.verify);
    const auto registers = registers_of(settings);
    EXPECT_EQ(registers.at(chip(0x3067)), 0x80U | 0x20U);  // only ON
    EXPECT_EQ(registers.at(chip(0x3204)), 3U << 3 | 3U);   // every fourth
    EXPECT_EQ(registers.at(chip(0x3200)) & 0x04U, 0U);     // subsampling is on
    EXPECT_EQ(registers.at(chip(0x3500)), 0U);             // activity decision is not bypassed
    EXPECT_EQ(registers.at(chip(0x3501)), 1000U >> 8);
    EXPECT_EQ(registers.at(chip(0x3502)), 1000U & 0xFF);
    EXPECT_EQ(registers.at(chip(0x3300)), 0U);  // nor is the cropper
    EXPECT_EQ(registers.at(davis::kUsbEarlyPacketDelay), 500U * 30);
    EXPECT_EQ(registers.at({davis::imu, 7}), 2U);   // 8 g
    EXPECT_EQ(registers.at({davis::imu, 10}), 4U);  // 125 deg/s
}

TEST(DvxplorerSettings, RefusesWhatItDoesNotKnowWithItsLine) {
    const auto refusal = [](const std::string& text) {
        return error_of([&] { load_dvxplorer_settings(written(text)); }, ErrorKind::usage);
    };
    EXPECT_THAT(refusal("imu = true\nexposure_us = 3\n"),
                HasSubstr("usb_camera.toml:2: unknown key 'exposure_us'"));
    EXPECT_THAT(refusal("contrast_on = 18"), HasSubstr("from 0 to 17, found 18"));
    EXPECT_THAT(refusal("polarity = 'up'"), HasSubstr("expected \"both\""));
    EXPECT_THAT(refusal("roi = [1, 2]"), HasSubstr("[x, y, width, height]"));
    EXPECT_THAT(error_of(
                    [] {
                        DvxplorerSettings settings;
                        settings.roi = SensorRegion{600, 0, 100, 10};
                        configuration(settings, {}, {});
                    },
                    ErrorKind::usage),
                HasSubstr("reaches to 700,10, this sensor has 640x480"));
}

TEST(DvxplorerSettings, ContrastsHitThePresetsOfLibcaer) {
    struct Preset {
        int threshold;
        std::uint32_t range_on, level_off, on, off;
    };
    for (const Preset preset : {Preset{15, 0x06, 0x7D, 6, 2},
                                {12, 0x06, 0x7D, 3, 5},
                                {9, 0x06, 0x7D, 0, 8},
                                {5, 0x04, 0x7F, 5, 3},
                                {2, 0x04, 0x7F, 2, 6}}) {
        DvxplorerSettings settings;
        settings.contrast_on = settings.contrast_off = preset.threshold;
        const auto registers = registers_of(settings);
        EXPECT_EQ(registers.at(chip(0x0B)), preset.range_on) << preset.threshold;
        EXPECT_EQ(registers.at(chip(0x12)), preset.level_off) << preset.threshold;
        EXPECT_EQ(registers.at(chip(0x1C)), preset.on) << preset.threshold;
        EXPECT_EQ(registers.at(chip(0x1E)), preset.off) << preset.threshold;
    }
}

TEST(DvxplorerSettings, TheChipOfTheRedBoardIsSetUpAsKnownDriversDo) {
    // docs/protocols.md A.12; contrast and mode come later.
    const std::vector<Write> expected{
        {chip(0x000D), 0x24}, {chip(0x000F), 0x07}, {chip(0x0010), 0xFF}, {chip(0x0013), 0x03},
        {chip(0x0014), 0x7F}, {chip(0x0015), 0x00}, {chip(0x3011), 0xA0}, {chip(0x3019), 0x00},
        {chip(0x301E), 0x01}, {chip(0x3067), 0x80}, {chip(0x3255), 0x0C}, {chip(0x3266), 0x08},
        {chip(0x3235), 0x03}, {chip(0x3236), 0xE7}, {chip(0x3234), 49},   {chip(0x323D), 50},
        {chip(0x3243), 50},   {chip(0x3247), 50},   {chip(0x3259), 50},   {chip(0x3600), 0x01}};
    EXPECT_EQ(chip_writes(), expected);
}

TEST(DvxplorerSettings, AMiniIsToldNothingOfTheModulesItHasNot) {
    DvxplorerFeatures mini;
    mini.mini = true;
    for (const Write& write : configuration({}, {}, mini))
        EXPECT_THAT(write.at.module, testing::AnyOf(davis::imu, davis::chip));
}

TEST(DvxplorerSettings, ALiteCountsItsSubsamplingAsLibcaerDoes) {
    DvxplorerFeatures lite;
    lite.lite = true;
    for (const auto& [subsample, ratio] : {std::pair{1, 1U}, {2, 3U}, {4, 7U}}) {
        DvxplorerSettings settings;
        settings.subsample = subsample;
        const auto registers = registers_of(settings, lite);
        EXPECT_EQ(registers.at(chip(0x3204)), ratio << 3 | ratio) << subsample;
        EXPECT_EQ(registers.count(chip(0x3202)), 0U) << "it has no dual binning";
    }
    EXPECT_THAT(error_of(
                    [&] {
                        DvxplorerSettings settings;
                        settings.subsample = 8;
                        configuration(settings, {}, lite);
                    },
                    ErrorKind::usage),
                HasSubstr("subsample: expected 1, 2 or 4 for a DVXplorer Lite, found 8"));
}

}  // namespace
}  // namespace eventide::test
