// Durations as text: one place reads and writes them.
#pragma once

#include "src/core/sensor_time.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

namespace eventide {

/// "250us", "20ms" or "1.5s", to the microsecond; nothing for any other text, and beyond 1e12 s:
/// far past every clock.
inline std::optional<SensorDuration> read_duration(std::string_view text) noexcept {
    double value = 0;
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, value);
    const std::string_view unit{rest, std::size_t(end - rest)};
    const double us_per_unit = unit == "us" ? 1 : unit == "ms" ? 1e3 : unit == "s" ? 1e6 : 0;
    const double us = value * us_per_unit;
    if (error != std::errc{} || us_per_unit == 0 || !(std::abs(us) <= 1e18)) return std::nullopt;
    return SensorDuration{std::llround(us)};
}

/// What read_duration() reads back, in the largest unit that leaves a whole number.
inline std::string duration_text(SensorDuration duration) {
    const auto us = duration.count();
    if (us % 1'000'000 == 0) return std::to_string(us / 1'000'000) + "s";
    if (us % 1'000 == 0) return std::to_string(us / 1'000) + "ms";
    return std::to_string(us) + "us";
}

}  // namespace eventide
