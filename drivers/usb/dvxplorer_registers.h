// The registers of the DVXplorer beyond those it shares with the DAVIS: the Samsung chip's, 8 bits
// each, in module 5 (docs/protocols.md A.12; figures from libcaer 3.3.15, src/dvxplorer.h).
// Numbers of more bits take several, the highest first.
#pragma once

#include "drivers/usb/davis_registers.h"

namespace eventide::dvxplorer {

using davis::Register;
using davis::Write;

constexpr Register chip_register(int address) {
    return {davis::chip, std::uint16_t(address)};
}

// Biases.
inline constexpr Register kBiasRangeOn = chip_register(0x000B);
inline constexpr Register kBiasRangeLog = chip_register(0x000C);
inline constexpr Register kBiasTrim = chip_register(0x000D);
inline constexpr Register kBiasPinsDbgp = chip_register(0x000F);
inline constexpr Register kBiasPinsDbgn = chip_register(0x0010);
inline constexpr Register kBiasLevelOff = chip_register(0x0012);
inline constexpr Register kBiasPinsBufp = chip_register(0x0013);
inline constexpr Register kBiasPinsBufn = chip_register(0x0014);
inline constexpr Register kBiasPinsDob = chip_register(0x0015);
inline constexpr Register kBiasAmp = chip_register(0x0018);
inline constexpr Register kBiasOn = chip_register(0x001C);
inline constexpr Register kBiasOff = chip_register(0x001E);

// System.
inline constexpr Register kMode = chip_register(0x3000);
inline constexpr Register kClockDivider = chip_register(0x3011);
inline constexpr Register kParallelOutControl = chip_register(0x3019);
inline constexpr Register kParallelOutEnable = chip_register(0x301E);
inline constexpr Register kPacketFormat = chip_register(0x3067);

// Readout.
inline constexpr Register kDigitalEnable = chip_register(0x3200);
inline constexpr Register kRestart = chip_register(0x3201);
inline constexpr Register kDualBinning = chip_register(0x3202);
inline constexpr Register kSubsampleRatio = chip_register(0x3204);
inline constexpr Register kTimestampSubUnit = chip_register(0x3234);
inline constexpr Register kTimestampRefUnit = chip_register(0x3235);  ///< 16 bits
inline constexpr Register kTimestampReset = chip_register(0x3238);
inline constexpr Register kFirstSelXStart = chip_register(0x323C);
inline constexpr Register kDtagReference = chip_register(0x323D);
inline constexpr Register kGhCount = chip_register(0x3240);  ///< three bytes
inline constexpr Register kGhCountFine = chip_register(0x3243);
inline constexpr Register kGrsCount = chip_register(0x3244);  ///< three bytes
inline constexpr Register kGrsCountFine = chip_register(0x3247);
inline constexpr Register kGlobalResetReadout = chip_register(0x3248);
inline constexpr Register kNextGhCount = chip_register(0x324B);
inline constexpr Register kSelXWidth = chip_register(0x324C);
inline constexpr Register kAyStart = chip_register(0x324E);
inline constexpr Register kAyEnd = chip_register(0x324F);
inline constexpr Register kMaxEvents = chip_register(0x3251);
inline constexpr Register kRStart = chip_register(0x3253);
inline constexpr Register kREnd = chip_register(0x3254);
inline constexpr Register kModeControl = chip_register(0x3255);
inline constexpr Register kGrsEnd = chip_register(0x3256);  ///< three bytes
inline constexpr Register kGrsEndFine = chip_register(0x3259);
inline constexpr Register kFixedReadTime = chip_register(0x325C);
inline constexpr Register kReadInterval = chip_register(0x325D);  ///< 16 bits
inline constexpr Register kExternalTrigger = chip_register(0x3260);
inline constexpr Register kNextSelXStart = chip_register(0x3261);  ///< 16 bits
inline constexpr Register kBootSequence = chip_register(0x3266);

// Region of interest: rows as groups of eight and masks in them.
inline constexpr Register kCropBypass = chip_register(0x3300);
inline constexpr Register kCropYStartGroup = chip_register(0x3301);
inline constexpr Register kCropYStartMask = chip_register(0x3302);
inline constexpr Register kCropYEndGroup = chip_register(0x3303);
inline constexpr Register kCropYEndMask = chip_register(0x3304);
inline constexpr Register kCropXStart = chip_register(0x3305);  ///< 16 bits
inline constexpr Register kCropXEnd = chip_register(0x3307);    ///< 16 bits

// Activity decision: whether a readout is sent at all.
inline constexpr Register kActivityBypass = chip_register(0x3500);
inline constexpr Register kActivityPositive = chip_register(0x3501);  ///< 16 bits
inline constexpr Register kActivityNegative = chip_register(0x3503);  ///< 16 bits
inline constexpr Register kActivityRate = chip_register(0x3505);
inline constexpr Register kActivityTime = chip_register(0x3506);
inline constexpr Register kActivityMostPositive = chip_register(0x3513);  ///< 16 bits
inline constexpr Register kHistogramOff = chip_register(0x3600);

/// Values of kMode.
inline constexpr std::uint32_t kModeOff = 0, kModeStream = 2;

// In the IMU module, where the DAVIS has other things: a Bosch BMI160.
inline constexpr Register kImuAccelRate{davis::imu, 5}, kImuAccelFilter{davis::imu, 6},
    kImuAccelRange{davis::imu, 7}, kImuGyroRate{davis::imu, 8}, kImuGyroFilter{davis::imu, 9},
    kImuGyroRange{davis::imu, 10};

}  // namespace eventide::dvxplorer
