// Times as data sets write them: seconds in floating point.
#pragma once

#include "src/core/sensor_time.h"

#include <cmath>
#include <optional>

namespace eventide {

/// Rounded to the nearest microsecond.
inline SensorDuration duration_from_seconds(double seconds) {
    return SensorDuration{std::llround(seconds * 1e6)};
}

/// Empty for what is no time: not a number, or farther away than 30,000 years.
inline std::optional<SensorTime> time_from_seconds(double seconds) {
    constexpr double kFarthestSeconds = 1e12;  // in microseconds it fits 64 bits
    if (!(std::abs(seconds) <= kFarthestSeconds)) return std::nullopt;
    return SensorTime{duration_from_seconds(seconds)};
}

}  // namespace eventide
