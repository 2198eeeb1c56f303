/// @file
/// Two clocks that never mix: the camera's and the computer's.
#pragma once

#include <chrono>
#include <cstdint>

namespace eventide {

/// The camera's own clock. Only its data tell it, so it has no now(). Epoch: whatever the stream
/// says (microseconds since the camera's start, or since 1970).
struct SensorClock {
    using rep = std::int64_t;                                 ///< of whole us
    using period = std::micro;                                ///< us
    using duration = std::chrono::duration<rep, period>;      ///< whole us
    using time_point = std::chrono::time_point<SensorClock>;  ///< since the stream's epoch
    static constexpr bool is_steady = true;                   ///< within one stream
};

using SensorTime = SensorClock::time_point;              ///< a time of the sensor's clock
using SensorDuration = SensorClock::duration;            ///< us of the sensor's clock
using HostTime = std::chrono::steady_clock::time_point;  ///< a time of the computer's

/// The time `us` microseconds after the clock's epoch.
constexpr SensorTime from_us(std::int64_t us) {
    return SensorTime{SensorDuration{us}};
}
/// Microseconds since the clock's epoch.
constexpr std::int64_t to_us(SensorTime t) {
    return t.time_since_epoch().count();
}

/// The time span of an event window, (begin, end]: begin < t <= end.
struct Window {
    SensorTime begin;  ///< does not belong to it
    SensorTime end;    ///< belongs to it

    constexpr SensorDuration width() const { return end - begin; }             ///< its length
    friend constexpr bool operator==(const Window&, const Window&) = default;  ///< both times
};

}  // namespace eventide
