// Frames, IMU samples and special events of AEDAT 3, record by record, both ways.
#pragma once

#include "src/core/event.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace eventide {

/// Numbers of special events; triggers of further kinds and inputs use one of these and the data
/// field (see write_special()).
enum class Aedat3Special : std::uint8_t {
    timestamp_wrap = 0,
    timestamp_reset = 1,
    rising = 2,
    falling = 3,
    pulse = 4,
    row_only = 5,
    rising_1 = 6,
    falling_1 = 7,
    pulse_1 = 8,
    rising_2 = 9,
    falling_2 = 10,
    pulse_2 = 11,
    generator_rising = 12,
    generator_falling = 13,
    frame_begin = 14,
    frame_end = 15,
    exposure_begin = 16,
    exposure_end = 17,
    other = 127
};

/// The trigger of a special event's first word, without its time; empty for wraps and row-only
/// marks, which say nothing beside their time.
std::optional<Trigger> read_special(std::uint32_t word);
std::uint32_t write_special(const Trigger& trigger);

/// A record of 36 bytes, or 48 with a magnetometer. `base_us`: what the packet's overflow adds.
ImuSample read_imu(std::span<const std::byte> record, std::int64_t base_us);
void write_imu(const ImuSample& sample, bool with_magnetometer, std::uint32_t stamp,
               std::vector<std::byte>& out);

/// Empty where the fields contradict each other or the record's length. `lower_left`: rows from
/// the bottom up (AEDAT 3.0), in a sensor of `height` px.
std::optional<ReferenceImage> read_frame(std::span<const std::byte> record, std::int64_t base_us,
                                         bool lower_left, int height);
void write_frame(const ReferenceImage& image, ColourFilter filter, std::int64_t base_us,
                 std::vector<std::byte>& out);

}  // namespace eventide
