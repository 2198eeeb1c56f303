// Times as data sets write them: seconds in floating point.
#pragma once

#include "src/core/sensor_time.h"

#include <cmath>
#include <optional>

namespace eventide {

/// Empty for what is no time: not a number, or farther away than 30,000 years.
inline std::optional<SensorTime> time_from_seconds(double seconds) {
    constexpr double kFarthestSeconds = 1e12;  // in microseconds it fits 64 bits
    if (!(std::abs(seconds) <= kFarthestSeconds)) return std::nullopt;
    return from_us(std::llround(seconds * 1e6));
}

}  // namespace eventide
