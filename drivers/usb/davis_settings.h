// How a DAVIS is to be set up, and the register writes that do it.
#pragma once

#include "drivers/usb/davis_registers.h"
#include "drivers/usb/usb_settings.h"
#include "src/codec/inivation/davis_sensor.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace eventide {

struct DavisSettings {
    bool frames = true;  ///< read APS frames
    std::optional<SensorRegion> frame_roi;
    bool global_shutter = true;     ///< where the chip has one
    int exposure_us = 4000;         ///< 0 to 4194303
    int frame_interval_us = 40000;  ///< 0 to 8388607
    bool auto_exposure = true;      ///< follows the frames' brightness

    bool imu = true;
    int accel_range_g = 4;     ///< 2, 4, 8, 16
    int gyro_range_dps = 500;  ///< 250, 500, 1000, 2000

    // What limits the event rate, on the camera.
    bool activity_filter = true;  ///< drops events without a neighbour
    int activity_time_us = 2000;  ///< in steps of 250
    int refractory_us = 0;        ///< of each pixel, in steps of 250; 0 none
    std::optional<SensorRegion> roi;
    SentPolarity polarity = SentPolarity::both;
    std::vector<std::pair<int, int>> hot_pixels;  ///< x, y of up to eight that are never sent
    int skip_every = 0;                           ///< leaves out one event in so many; 0 none

    bool detect_pulses = true;  ///< on the external input
    bool detect_edges = false;

    std::map<std::string, std::uint32_t> biases;  ///< 16 bits, by name, instead of the defaults
    UsbStreamSettings transfers;
    int early_packet_delay_us =
        1000;            ///< a partly filled packet is sent after this: bounds the latency
    bool verify = true;  ///< read back what was written
};

/// config/cameras/*.toml. Unknown keys and values out of range are refused with file and line
/// (Error, usage).
DavisSettings load_davis_settings(const std::filesystem::path& file);

struct DavisBias {
    const char* name;
    std::uint16_t address;
    std::uint16_t value;  ///< 16-bit word (docs/protocols.md A.7)
};
/// libcaer's defaults.
const std::vector<DavisBias>& default_biases(DavisChip chip);

/// What the logic says it can do.
struct DavisFeatures {
    bool global_shutter = true, pixel_filter = true, activity_filter = true, roi = true,
         skip = true, polarity_filter = true, generator = true;
    bool statistics = true;  ///< of the multiplexer: what it dropped
    int logic_mhz = 90, adc_mhz = 30, usb_mhz = 30, deviation = 1000;  ///< MHz; per mille
};

/// All writes that configure an idle camera, in order: chip and biases, multiplexer, DVS, APS, IMU,
/// external input, USB. Throws Error (usage) for a bias the chip does not have, a region or pixel
/// outside the sensor, or what this logic cannot do.
std::vector<davis::Write> configuration(const DavisSettings& settings, const DavisSensor& sensor,
                                        const DavisFeatures& features);

/// Exposure and interval go over the wire in cycles of the ADC's real clock.
std::uint32_t adc_cycles(int us, const DavisFeatures& features);

/// Idle: the first writes of a start, and the whole of a stop (A.8).
std::vector<davis::Write> idle_writes();
/// Lets the data flow, after the biases settled.
std::vector<davis::Write> flow_writes();
/// Starts the parts that make data.
std::vector<davis::Write> run_writes(const DavisSettings& settings);

}  // namespace eventide
