// What a recording holds, counted by reading all of it.
#pragma once

#include "replay/recording.h"
#include "src/core/damage.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace eventide {

struct Summary {
    std::string format;  ///< as in StreamHeader::format
    int width = 0, height = 0;
    std::uint64_t events = 0;
    std::uint64_t on = 0;  ///< of the events
    /// Times of the first and the last event; empty where there are none.
    std::optional<SensorTime> first, last;
    SensorDuration span{};           ///< from first to last, by each of the clocks in turn
    std::uint64_t clock_resets = 0;  ///< how often the sensor's clock was reset
    std::uint64_t frames = 0, imu = 0, triggers = 0;
    /// Events that came while light flickered, as FlickerPeriod finds it, and its frequency in Hz,
    /// averaged over them; 0 where it did not.
    std::uint64_t in_flicker = 0;
    double flicker_hz = 0;
    Damage damaged;
};

/// Reads the recording to its end, in bounded memory. `progress` is called after each chunk and
/// may return false to stop there.
Summary summarize(Recording& recording, const std::function<bool()>& progress = {});

/// Reads on, from the recording's beginning, as far as its first event; empty where it has none.
std::optional<SensorTime> first_event_time(Recording& recording);

/// One object: format, width, height, events, on, first_us, last_us (null without events),
/// clock_resets, frames, imu, triggers, flicker_hz (null where no light flickered), in_flicker,
/// damaged (counts by reason, all reasons).
std::string to_json(const Summary& summary);

}  // namespace eventide
