// How a DVXplorer is to be set up, and the register writes that do it.
#pragma once

#include "drivers/usb/dvxplorer_registers.h"
#include "drivers/usb/usb_settings.h"
#include "src/codec/inivation/dvxplorer_sensor.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace eventide {

struct DvxplorerSettings {
    /// Thresholds of the contrast that makes an event, 0 to 17: more is less sensitive. libcaer's
    /// presets, from "very low" to "very high" sensitivity, are 15, 12, 9, 5, 2 for both.
    int contrast_on = 9, contrast_off = 9;

    // What limits the event rate, on the camera.
    std::optional<SensorRegion> roi;
    SentPolarity polarity = SentPolarity::both;
    /// Every pixel, or every 2nd, 4th, 8th (not of a Lite) in both directions.
    int subsample = 1;
    /// Readouts are sent only where enough happens: from `activity_positive` events up, until fewer
    /// than `activity_negative`.
    bool activity_decision = false;
    int activity_positive = 300, activity_negative = 20;

    bool imu = true;
    int accel_range_g = 4;     ///< 2, 4, 8, 16
    int gyro_range_dps = 500;  ///< 125, 250, 500, 1000, 2000

    bool detect_pulses = true;  ///< on the external input
    bool detect_edges = false;

    UsbStreamSettings transfers;
    int early_packet_delay_us =
        1000;            ///< a partly filled packet is sent after this: bounds the latency
    bool verify = true;  ///< read back what was written
};

/// config/cameras/*.toml. Unknown keys and values out of range are refused with file and line
/// (Error, usage).
DvxplorerSettings load_dvxplorer_settings(const std::filesystem::path& file);

/// What the camera says of itself.
struct DvxplorerFeatures {
    bool mini = false;  ///< a CX3 board (Mini, Micro): no multiplexer, external input or USB module
    bool lite = false;  ///< chip 19: other ratios of subsampling, no dual binning
    bool flip_x = false, flip_y = false;  ///< orientation bits 1, 0
    bool statistics = true, generator = true;
    int logic_mhz = 104, usb_mhz = 30, deviation = 1000;  ///< MHz; per mille
    /// Registers of which only some bits are set: what they held before.
    std::uint32_t packet_format = 0x80, mode_control = 0x0C, digital_enable = 0;
};

/// First the chip is powered, 10 ms; then these. A Mini does both itself.
std::vector<davis::Write> chip_writes();

/// All writes that configure an idle camera, in order. Throws Error (usage) for a region outside
/// the sensor, and for a subsampling that a Lite has not got.
std::vector<davis::Write> configuration(const DvxplorerSettings& settings,
                                        const DvxplorerSensor& sensor,
                                        const DvxplorerFeatures& features);

/// No data any more; in the order of a stop.
std::vector<davis::Write> dvxplorer_idle_writes(bool mini);
/// Opens the way to the host. Nothing on a Mini.
std::vector<davis::Write> dvxplorer_flow_writes(bool mini);
/// Starts what makes data, the chip last.
std::vector<davis::Write> dvxplorer_run_writes(const DvxplorerSettings& settings, bool mini);

}  // namespace eventide
