#include "drivers/usb/davis_settings.h"

#include "src/core/error.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string>
#include <tuple>

namespace eventide {
namespace {

using namespace davis;

// docs/protocols.md A.7, from libcaer's src/davis.c.
const std::vector<DavisBias> kBiases346{{"ApsOverflowLevel", 0, 0x019B},
                                        {"ApsCas", 1, 0x0195},
                                        {"AdcRefHigh", 2, 0x01E0},
                                        {"AdcRefLow", 3, 0x01C1},
                                        {"AdcTestVoltage", 4, 0x01D5},
                                        {"LocalBufBn", 8, 0x5A4F},
                                        {"PadFollBn", 9, 0x7D7E},
                                        {"DiffBn", 10, 0x427F},
                                        {"OnBn", 11, 0x5FFF},
                                        {"OffBn", 12, 0x401F},
                                        {"PixInvBn", 13, 0x690F},
                                        {"PrBp", 14, 0x23AD},
                                        {"PrSFBp", 15, 0x110D},
                                        {"RefrBp", 16, 0x419D},
                                        {"ReadoutBufBp", 17, 0x614D},
                                        {"ApsROSFBn", 18, 0x6DBF},
                                        {"AdcCompBp", 19, 0x514D},
                                        {"ColSelLowBn", 20, 0x001F},
                                        {"DACBufBp", 21, 0x63CD},
                                        {"LcolTimeoutBn", 22, 0x531F},
                                        {"AEPdBn", 23, 0x65BF},
                                        {"AEPuXBp", 24, 0x450D},
                                        {"AEPuYBp", 25, 0x798D},
                                        {"IfRefrBn", 26, 0x5FFF},
                                        {"IfThrBn", 27, 0x5FFF},
                                        {"BiasBuffer", 34, 0x5FEF},
                                        {"SSP", 35, 0x8410},
                                        {"SSN", 36, 0x8410}};

const std::vector<DavisBias> kBiases240{{"DiffBn", 0, 0x427F},
                                        {"OnBn", 1, 0x5FFF},
                                        {"OffBn", 2, 0x400F},
                                        {"ApsCasEpc", 3, 0x5B9B},
                                        {"DiffCasBnc", 4, 0x573B},
                                        {"ApsROSFBn", 5, 0x6DBF},
                                        {"LocalBufBn", 6, 0x5A4F},
                                        {"PixInvBn", 7, 0x690F},
                                        {"PrBp", 8, 0x23AD},
                                        {"PrSFBp", 9, 0x110D},
                                        {"RefrBp", 10, 0x419D},
                                        {"AEPdBn", 11, 0x65BF},
                                        {"LcolTimeoutBn", 12, 0x531F},
                                        {"AEPuXBp", 13, 0x450D},
                                        {"AEPuYBp", 14, 0x798D},
                                        {"IfThrBn", 15, 0x5FFF},
                                        {"IfRefrBn", 16, 0x5FFF},
                                        {"PadFollBn", 17, 0x7D7F},
                                        {"ApsOverflowLevelBn", 18, 0x6FDF},
                                        {"BiasBuffer", 19, 0x5FEF},
                                        {"SSP", 20, 0x8410},
                                        {"SSN", 21, 0x8410}};

using Writes = std::vector<Write>;

void add(Writes& writes, Register at, int value) {
    writes.push_back({at, std::uint32_t(value)});
}

void add_chip(Writes& writes, const DavisSettings& settings, const DavisSensor& sensor,
              const DavisFeatures& features) {
    auto wanted = settings.biases;
    for (const DavisBias& bias : default_biases(sensor.chip)) {
        const auto own = wanted.extract(bias.name);
        add(writes, {chip, bias.address}, own.empty() ? bias.value : int(own.mapped()));
    }
    if (!wanted.empty())
        throw Error(ErrorKind::usage,
                    "camera settings: this chip has no bias '" + wanted.begin()->first + "'");

    const auto bit = [&](int offset, int value) {
        add(writes, {chip, std::uint16_t(kChipConfig + offset)}, value);
    };
    // A.6: multiplexers off, calibration neuron and test pixel held in reset, grey counter on.
    for (int offset = 0; offset <= 7; ++offset) bit(offset, 0);
    bit(8, 1);
    bit(9, 0);
    bit(10, 1);
    if (sensor.chip == DavisChip::davis240a || sensor.chip == DavisChip::davis240b) bit(11, 0);
    bit(12, 0);
    bit(13, 0);
    bit(14, features.global_shutter && settings.global_shutter ? 1 : 0);
    if (sensor.is_davis240()) return;  // it has neither of these
    bit(15, 1);
    bit(16, 0);
}

/// Wanted, but this logic says it cannot do it.
void require(bool can, bool wanted, const char* setting) {
    if (wanted && !can)
        throw Error(ErrorKind::usage, std::string{"camera settings: "} + setting +
                                          ": this camera's logic was built without it");
}

constexpr int kFilterStepUs = 250;
constexpr std::size_t kHotPixels = 8;

/// A place outside the sensor means "off".
void add_hot_pixels(Writes& writes, const DavisSettings& settings, const DavisSensor& sensor) {
    for (std::size_t i = 0; i < kHotPixels; ++i) {
        int x = sensor.width(), y = sensor.height();
        if (i < settings.hot_pixels.size()) {
            std::tie(x, y) = settings.hot_pixels[i];
            require_inside({x, y, 1, 1}, "hot_pixels", sensor.width(), sensor.height());
        }
        add(writes, {dvs, std::uint16_t(11 + 2 * i)}, y);
        add(writes, {dvs, std::uint16_t(12 + 2 * i)}, x);
    }
}

/// In the frame's axes, also on chips whose axes are swapped.
void add_region(Writes& writes, const std::optional<SensorRegion>& asked, const char* name,
                int width, int height, std::array<Register, 4> start_and_end) {
    const SensorRegion region = asked.value_or(SensorRegion{0, 0, width, height});
    require_inside(region, name, width, height);
    const std::array<int, 4> values{region.x, region.y, region.x + region.width - 1,
                                    region.y + region.height - 1};
    for (std::size_t i = 0; i < values.size(); ++i) add(writes, start_and_end[i], values[i]);
}

void add_polarity(Writes& writes, SentPolarity polarity) {
    const bool one = polarity == SentPolarity::on || polarity == SentPolarity::off;
    add(writes, kDvsPolarityFlatten, polarity == SentPolarity::flat ? 1 : 0);
    add(writes, kDvsPolaritySuppress, one ? 1 : 0);
    add(writes, kDvsPolarityWhich, polarity == SentPolarity::off ? 1 : 0);  // the one left out
}

void add_dvs(Writes& writes, const DavisSettings& settings, const DavisSensor& sensor,
             const DavisFeatures& features) {
    require(features.pixel_filter, !settings.hot_pixels.empty(), "hot_pixels");
    require(features.activity_filter, settings.refractory_us > 0, "refractory_us");
    require(features.roi, settings.roi.has_value(), "roi");
    require(features.skip, settings.skip_every > 0, "skip_every");
    require(features.polarity_filter, settings.polarity != SentPolarity::both, "polarity");
    add(writes, kDvsWaitOnStall, 0);
    add(writes, kDvsExternalAer, 0);
    if (features.pixel_filter) add_hot_pixels(writes, settings, sensor);
    if (features.activity_filter) {
        add(writes, kDvsActivityFilter, settings.activity_filter ? 1 : 0);
        add(writes, kDvsActivityTime, settings.activity_time_us / kFilterStepUs);
        add(writes, kDvsRefractory, settings.refractory_us > 0 ? 1 : 0);
        add(writes, kDvsRefractoryTime, std::max(1, settings.refractory_us / kFilterStepUs));
    }
    if (features.roi)
        add_region(writes, settings.roi, "roi", sensor.width(), sensor.height(),
                   {kDvsRoiStartColumn, kDvsRoiStartRow, kDvsRoiEndColumn, kDvsRoiEndRow});
    if (features.skip) {
        add(writes, kDvsSkip, settings.skip_every > 0 ? 1 : 0);
        add(writes, kDvsSkipEvery, settings.skip_every > 0 ? settings.skip_every : 5);
    }
    if (features.polarity_filter) add_polarity(writes, settings.polarity);
}

void add_aps(Writes& writes, const DavisSettings& settings, const DavisSensor& sensor,
             const DavisFeatures& features) {
    add(writes, kApsWaitOnStall, 1);
    add(writes, kApsGlobalShutter, features.global_shutter && settings.global_shutter ? 1 : 0);
    add_region(writes, settings.frame_roi, "frame_roi", sensor.aps_width(), sensor.aps_height(),
               {kApsStartColumn, kApsStartRow, kApsEndColumn, kApsEndRow});
    writes.push_back({kApsExposure, adc_cycles(settings.exposure_us, features)});
    writes.push_back({kApsInterval, adc_cycles(settings.frame_interval_us, features)});
}

void add_imu(Writes& writes, const DavisSettings& settings, const DavisSensor& sensor) {
    if (sensor.imu_type == kNoImu) return;
    add(writes, kImuRateDivider, 0);
    add(writes, kImuAccelLowPass, 1);
    add(writes, kImuAccelScale,
        std::countr_zero(unsigned(settings.accel_range_g)) - 1);  // 2 g << code
    if (sensor.imu_type == kImuMpu6500) add(writes, kImuGyroLowPass, 1);
    add(writes, kImuGyroScale,
        std::countr_zero(unsigned(settings.gyro_range_dps / 250)));  // 250 << code
}

void add_extinput(Writes& writes, const DavisSettings& settings, const DavisFeatures& features) {
    add(writes, kExtRising, settings.detect_edges ? 1 : 0);
    add(writes, kExtFalling, settings.detect_edges ? 1 : 0);
    add(writes, kExtPulses, settings.detect_pulses ? 1 : 0);
    add(writes, kExtPulsePolarity, 1);
    constexpr double kPulseUs = 10;
    add(writes, kExtPulseLength,
        int(std::lround(kPulseUs * features.logic_mhz * features.deviation / 1000)));
    if (features.generator) add(writes, kExtGeneratorRun, 0);
}

}  // namespace

std::uint32_t adc_cycles(int us, const DavisFeatures& features) {
    return std::uint32_t(std::int64_t(us) * features.adc_mhz * features.deviation / 1000);
}

const std::vector<DavisBias>& default_biases(DavisChip chip) {
    return chip <= DavisChip::davis240c ? kBiases240 : kBiases346;
}

Writes configuration(const DavisSettings& settings, const DavisSensor& sensor,
                     const DavisFeatures& features) {
    Writes writes;
    add_chip(writes, settings, sensor, features);
    add(writes, kTimestampReset, 0);
    add(writes, kDropExtinputOnStall, 1);
    add(writes, kDropDvsOnStall, 1);
    add_dvs(writes, settings, sensor, features);
    add_aps(writes, settings, sensor, features);
    add_imu(writes, settings, sensor);
    add_extinput(writes, settings, features);
    const double usb_cycles_per_us = features.usb_mhz * features.deviation / 1000.0;
    add(writes, kUsbEarlyPacketDelay, int(settings.early_packet_delay_us * usb_cycles_per_us));
    return writes;
}

Writes idle_writes() {
    Writes writes;
    for (const Register at : {kDvsRun, kApsRun, kImuRunAccel, kImuRunGyro, kImuRunTemperature,
                              kExtRun, kRun, kTimestampRun, kUsbRun, kRunChip})
        add(writes, at, 0);
    return writes;
}

Writes flow_writes() {
    return {{kUsbRun, 1}, {kTimestampRun, 1}, {kRun, 1}};
}

Writes run_writes(const DavisSettings& settings) {
    Writes writes;
    add(writes, kDvsRun, 1);
    if (settings.frames) add(writes, kApsRun, 1);
    if (settings.imu)
        for (const Register at : {kImuRunAccel, kImuRunGyro, kImuRunTemperature})
            add(writes, at, 1);
    add(writes, kExtRun, 1);
    return writes;
}

}  // namespace eventide
