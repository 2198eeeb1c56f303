// The registers of iniVation's DAVIS and DVXplorer logic (docs/protocols.md A.4; figures from
// libcaer 3.3.15, include/libcaer/devices/davis.h).
#pragma once

#include <compare>
#include <cstdint>

namespace eventide::davis {

enum Module : std::uint16_t {
    mux = 0,
    dvs = 1,
    aps = 2,
    imu = 3,
    extinput = 4,
    chip = 5,
    sysinfo = 6,
    usb = 9
};

struct Register {
    std::uint16_t module = 0, address = 0;
    // NOLINTNEXTLINE(modernize-use-nullptr): clang-tidy's own mistake
    friend constexpr auto operator<=>(const Register&, const Register&) = default;
};

struct Write {
    Register at;
    std::uint32_t value = 0;
    friend constexpr bool operator==(const Write&, const Write&) = default;
};

inline constexpr Register kRun{mux, 0}, kTimestampRun{mux, 1}, kTimestampReset{mux, 2},
    kRunChip{mux, 3}, kDropExtinputOnStall{mux, 4}, kDropDvsOnStall{mux, 5},
    kMuxHasStatistics{mux, 80}, kMuxDroppedDvs{mux, 83};

inline constexpr Register kDvsColumns{dvs, 0}, kDvsRows{dvs, 1}, kDvsOrientation{dvs, 2},
    kDvsRun{dvs, 3}, kDvsWaitOnStall{dvs, 4}, kDvsExternalAer{dvs, 5}, kDvsHasPixelFilter{dvs, 10},
    kDvsHasActivityFilter{dvs, 30}, kDvsActivityFilter{dvs, 31}, kDvsActivityTime{dvs, 32},
    kDvsRefractory{dvs, 33}, kDvsRefractoryTime{dvs, 34}, kDvsHasRoi{dvs, 40},
    kDvsRoiStartColumn{dvs, 41}, kDvsRoiStartRow{dvs, 42}, kDvsRoiEndColumn{dvs, 43},
    kDvsRoiEndRow{dvs, 44}, kDvsHasSkip{dvs, 50}, kDvsSkip{dvs, 51}, kDvsSkipEvery{dvs, 52},
    kDvsHasPolarityFilter{dvs, 60}, kDvsPolarityFlatten{dvs, 61}, kDvsPolaritySuppress{dvs, 62},
    kDvsPolarityWhich{dvs, 63}, kDvsHasStatistics{dvs, 80};

inline constexpr Register kApsColumns{aps, 0}, kApsRows{aps, 1}, kApsOrientation{aps, 2},
    kApsColorFilter{aps, 3}, kApsRun{aps, 4}, kApsWaitOnStall{aps, 5}, kApsHasGlobalShutter{aps, 6},
    kApsGlobalShutter{aps, 7}, kApsStartColumn{aps, 8}, kApsStartRow{aps, 9},
    kApsEndColumn{aps, 10}, kApsEndRow{aps, 11}, kApsExposure{aps, 12}, kApsInterval{aps, 13};

inline constexpr Register kImuType{imu, 0}, kImuOrientation{imu, 1}, kImuRunAccel{imu, 2},
    kImuRunGyro{imu, 3}, kImuRunTemperature{imu, 4}, kImuRateDivider{imu, 5},
    kImuAccelLowPass{imu, 6}, kImuAccelScale{imu, 7}, kImuGyroLowPass{imu, 9},
    kImuGyroScale{imu, 10};

inline constexpr Register kExtRun{extinput, 0}, kExtRising{extinput, 1}, kExtFalling{extinput, 2},
    kExtPulses{extinput, 3}, kExtPulsePolarity{extinput, 4}, kExtPulseLength{extinput, 5},
    kExtHasGenerator{extinput, 10}, kExtGeneratorRun{extinput, 11};

inline constexpr Register kLogicVersion{sysinfo, 0}, kChipId{sysinfo, 1}, kIsMaster{sysinfo, 2},
    kLogicMhz{sysinfo, 3}, kAdcMhz{sysinfo, 4}, kUsbMhz{sysinfo, 5}, kClockDeviation{sysinfo, 6},
    kLogicPatch{sysinfo, 7};

inline constexpr Register kUsbRun{usb, 0}, kUsbEarlyPacketDelay{usb, 1};

/// Chip configuration bits begin here; below are the biases.
inline constexpr std::uint16_t kChipConfig = 128;

}  // namespace eventide::davis
