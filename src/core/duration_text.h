// Durations and times as text: one place reads and writes them.
#pragma once

#include "src/core/sensor_time.h"

#include "src/core/number_text.h"

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace eventide {

/// "250us", "20ms" or "1.5s", to the microsecond; nothing for any other text, and beyond 1e12 s:
/// far past every clock.
inline std::optional<SensorDuration> read_duration(std::string_view text) noexcept {
    const auto value = take_number<double>(text);
    const double us_per_unit = text == "us" ? 1 : text == "ms" ? 1e3 : text == "s" ? 1e6 : 0;
    const double us = value.value_or(0) * us_per_unit;
    if (!value || us_per_unit == 0 || !(std::abs(us) <= 1e18)) return std::nullopt;
    return SensorDuration{std::llround(us)};
}

/// What read_duration() reads back, in the largest unit that leaves a whole number.
inline std::string duration_text(SensorDuration duration) {
    const auto us = duration.count();
    if (us % 1'000'000 == 0) return std::to_string(us / 1'000'000) + "s";
    if (us % 1'000 == 0) return std::to_string(us / 1'000) + "ms";
    return std::to_string(us) + "us";
}

/// Sensor time in seconds with all its microseconds: "1633953690.975951", "-0.000001". Doubles lose
/// them after 1970.
inline std::string seconds_text(SensorTime t) {
    constexpr std::uint64_t kSecond = 1'000'000;
    const std::int64_t us = to_us(t);
    const std::uint64_t size = us < 0 ? std::uint64_t(0) - std::uint64_t(us) : std::uint64_t(us);
    const std::string fraction = std::to_string(kSecond + size % kSecond);  // a 1 in front
    return (us < 0 ? "-" : "") + std::to_string(size / kSecond) + "." + fraction.substr(1);
}

}  // namespace eventide
