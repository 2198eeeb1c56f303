#include "drivers/usb/dvxplorer_settings.h"

#include "src/core/error.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>
#include <utility>

namespace eventide {
namespace {

using namespace dvxplorer;
using davis::Write;
using Writes = std::vector<Write>;

void add(Writes& writes, Register at, int value) {
    writes.push_back({at, std::uint32_t(value)});
}

/// A number over `bytes` registers of eight bits, the highest first.
void add_bytes(Writes& writes, Register at, int bytes, int value) {
    for (int i = 0; i < bytes; ++i)
        add(writes, chip_register(at.address + i), (value >> (8 * (bytes - 1 - i))) & 0xFF);
}

int cycles(double us, int mhz, const DvxplorerFeatures& features) {
    return int(std::lround(us * mhz * features.deviation / 1000));
}

/// Thresholds below nine are in the low range of a current and those above in the high one; the
/// currents of OFF fall as its threshold rises. (dv-processing 2.0.4; libcaer's five presets are
/// values of this.)
void add_contrast(Writes& writes, const DvxplorerSettings& settings) {
    constexpr int kLevels = 9, kRangeSf = 0x04, kHighRangeOn = 0x02, kLevelOff = 0x7D,
                  kLowRangeOff = 0x02;
    const int on = settings.contrast_on, off = settings.contrast_off;
    add(writes, kBiasAmp, 4);
    add(writes, kBiasRangeLog, 0x14);
    add(writes, kBiasRangeOn, kRangeSf | (on < kLevels ? 0 : kHighRangeOn));
    add(writes, kBiasLevelOff, kLevelOff | (off < kLevels ? kLowRangeOff : 0));
    add(writes, kBiasOn, on % kLevels);
    add(writes, kBiasOff, kLevels - 1 - off % kLevels);
}

void add_imu(Writes& writes, const DvxplorerSettings& settings) {
    constexpr int kAccel800Hz = 6, kGyro800Hz = 5, kNormal = 2, kWidestDps = 2000;
    add(writes, kImuAccelRate, kAccel800Hz);
    add(writes, kImuAccelFilter, kNormal);
    add(writes, kImuAccelRange, std::countr_zero(unsigned(settings.accel_range_g)) - 1);
    add(writes, kImuGyroRate, kGyro800Hz);
    add(writes, kImuGyroFilter, kNormal);
    add(writes, kImuGyroRange,
        std::countr_zero(unsigned(kWidestDps / settings.gyro_range_dps)));  // widest first
}

void add_extinput(Writes& writes, const DvxplorerSettings& settings,
                  const DvxplorerFeatures& features) {
    constexpr double kPulseUs = 10;
    add(writes, davis::kExtRising, settings.detect_edges ? 1 : 0);
    add(writes, davis::kExtFalling, settings.detect_edges ? 1 : 0);
    add(writes, davis::kExtPulses, settings.detect_pulses ? 1 : 0);
    add(writes, davis::kExtPulsePolarity, 1);
    add(writes, davis::kExtPulseLength, cycles(kPulseUs, features.logic_mhz, features));
    if (features.generator) add(writes, davis::kExtGeneratorRun, 0);
}

/// 0, 1, 3, 7 for every, every 2nd, 4th, 8th row or column; of a Lite 1, 3, 7 for every, every 2nd,
/// 4th (docs/protocols.md A.12).
int subsample_ratio(int subsample, const DvxplorerFeatures& features) {
    constexpr int kMost = 7;
    const int ratio = features.lite ? 2 * subsample - 1 : subsample - 1;
    if (ratio > kMost)
        throw Error(ErrorKind::usage,
                    "camera settings: subsample: expected 1, 2 or 4 for a DVXplorer Lite, found " +
                        std::to_string(subsample));
    return ratio;
}

/// libcaer's default configuration of the readout.
void add_readout(Writes& writes, const DvxplorerSettings& settings,
                 const DvxplorerFeatures& features) {
    constexpr std::uint32_t kGlobalHold = 0x01, kGlobalReset = 0x02;
    constexpr std::uint32_t kFlat = 0x40, kOnOnly = 0x20, kOffOnly = 0x10;
    constexpr std::uint32_t kNoSubsampling = 0x04, kNoAreaBlocking = 0x02;
    add(writes, kExternalTrigger, 0);
    writes.push_back({kModeControl, (features.mode_control | kGlobalHold) & ~kGlobalReset});
    add(writes, kGlobalResetReadout, 0);
    add(writes, kFixedReadTime, 0);
    const std::uint32_t polarity = settings.polarity == SentPolarity::flat  ? kFlat
                                   : settings.polarity == SentPolarity::on  ? kOnOnly
                                   : settings.polarity == SentPolarity::off ? kOffOnly
                                                                            : 0;
    writes.push_back(
        {kPacketFormat, (features.packet_format & ~(kFlat | kOnOnly | kOffOnly)) | polarity});
    const std::uint32_t others = features.digital_enable & ~(kNoSubsampling | kNoAreaBlocking);
    writes.push_back(
        {kDigitalEnable, others | kNoAreaBlocking | (settings.subsample > 1 ? 0 : kNoSubsampling)});
    if (!features.lite) add(writes, kDualBinning, 0);
    const int ratio = subsample_ratio(settings.subsample, features);
    add(writes, kSubsampleRatio, (ratio << 3) | ratio);  // vertical, horizontal
    add_bytes(writes, kGhCount, 3, 2);
    add_bytes(writes, kGrsCount, 3, 0);
    add_bytes(writes, kGrsEnd, 3, 1);
    add(writes, kFirstSelXStart, 4);
    add(writes, kSelXWidth, 6);
    add(writes, kAyStart, 4);
    add(writes, kAyEnd, 6);
    add(writes, kRStart, 8);
    add(writes, kREnd, 10);
    add_bytes(writes, kNextSelXStart, 2, 15);
    add(writes, kMaxEvents, 10);
    add(writes, kNextGhCount, 10);
    add_bytes(writes, kReadInterval, 2, 48000);
}

/// Columns by address, rows by groups of eight and masks in the first and last of them. Where both
/// are the same group only the last mask counts.
void add_crop(Writes& writes, const DvxplorerSettings& settings, const DvxplorerSensor& sensor,
              const DvxplorerFeatures& features) {
    SensorRegion region{0, 0, sensor.width, sensor.height};
    if (settings.roi) require_inside(region = *settings.roi, "roi", sensor.width, sensor.height);
    if (sensor.swapped) {
        std::swap(region.x, region.y);
        std::swap(region.width, region.height);
    }
    const int x = features.flip_x ? sensor.columns() - region.x - region.width : region.x;
    const int y = features.flip_y ? sensor.rows() - region.y - region.height : region.y;
    const int last_x = x + region.width - 1, last_y = y + region.height - 1;
    int first_mask = (0xFF << (y % 8)) & 0xFF, last_mask = 0xFF >> (7 - last_y % 8);
    if (y / 8 == last_y / 8) last_mask &= std::exchange(first_mask, 0xFF);
    add(writes, kCropBypass, settings.roi ? 0 : 1);
    add_bytes(writes, kCropXStart, 2, x);
    add_bytes(writes, kCropXEnd, 2, last_x);
    add(writes, kCropYStartGroup, y / 8);
    add(writes, kCropYStartMask, first_mask);
    add(writes, kCropYEndGroup, last_y / 8);
    add(writes, kCropYEndMask, last_mask);
}

void add_activity(Writes& writes, const DvxplorerSettings& settings) {
    add(writes, kActivityBypass, settings.activity_decision ? 0 : 1);
    add_bytes(writes, kActivityPositive, 2, settings.activity_positive);
    add_bytes(writes, kActivityNegative, 2, settings.activity_negative);
    add(writes, kActivityRate, 1);
    add(writes, kActivityTime, 3);
    add_bytes(writes, kActivityMostPositive, 2, settings.activity_positive);
}

}  // namespace

Writes chip_writes() {
    constexpr int kClockMhz = 50;
    Writes writes;
    // Biases (docs/protocols.md A.12, as libcaer and dv-processing write them).
    add(writes, kBiasTrim, 0x24);
    add(writes, kBiasPinsDbgp, 0x07);
    add(writes, kBiasPinsDbgn, 0xFF);
    add(writes, kBiasPinsBufp, 0x03);
    add(writes, kBiasPinsBufn, 0x7F);
    add(writes, kBiasPinsDob, 0x00);
    // System: clock by ten, eight-pixel groups in pairs ("MGROUP").
    add(writes, kClockDivider, 0xA0);
    add(writes, kParallelOutControl, 0x00);
    add(writes, kParallelOutEnable, 0x01);
    add(writes, kPacketFormat, 0x80);
    // Readout.
    add(writes, kModeControl, 0x0C);
    add(writes, kBootSequence, 0x08);
    add_bytes(writes, kTimestampRefUnit, 2, 999);
    add(writes, kTimestampSubUnit, kClockMhz - 1);
    for (const Register at : {kDtagReference, kGhCountFine, kGrsCountFine, kGrsEndFine})
        add(writes, at, kClockMhz);
    add(writes, kHistogramOff, 0x01);
    return writes;
}

Writes configuration(const DvxplorerSettings& settings, const DvxplorerSensor& sensor,
                     const DvxplorerFeatures& features) {
    constexpr int kRestartAll = 2;
    Writes writes;
    if (!features.mini) {
        add(writes, davis::kTimestampReset, 0);
        add(writes, davis::kDropExtinputOnStall, 1);
        add(writes, davis::kDropDvsOnStall, 0);
    }
    add_imu(writes, settings);
    if (!features.mini) {
        add_extinput(writes, settings, features);
        add(writes, davis::kUsbEarlyPacketDelay,
            cycles(settings.early_packet_delay_us, features.usb_mhz, features));
    }
    add_contrast(writes, settings);
    add_readout(writes, settings, features);
    add_crop(writes, settings, sensor, features);
    add_activity(writes, settings);
    add(writes, kRestart, kRestartAll);
    return writes;
}

Writes dvxplorer_idle_writes(bool mini) {
    Writes writes;
    add(writes, kMode, kModeOff);
    for (const Register at :
         {davis::kDvsRun, davis::kImuRunAccel, davis::kImuRunGyro, davis::kImuRunTemperature})
        add(writes, at, 0);
    if (!mini)
        for (const Register at :
             {davis::kExtRun, davis::kRun, davis::kTimestampRun, davis::kUsbRun})
            add(writes, at, 0);
    return writes;
}

Writes dvxplorer_flow_writes(bool mini) {
    if (mini) return {};
    return {{davis::kUsbRun, 1}, {davis::kTimestampRun, 1}, {davis::kRun, 1}};
}

Writes dvxplorer_run_writes(const DvxplorerSettings& settings, bool mini) {
    Writes writes;
    add(writes, davis::kDvsRun, 1);
    if (settings.imu)
        for (const Register at :
             {davis::kImuRunAccel, davis::kImuRunGyro, davis::kImuRunTemperature})
            add(writes, at, 1);
    if (!mini) add(writes, davis::kExtRun, 1);
    return writes;
}

}  // namespace eventide
