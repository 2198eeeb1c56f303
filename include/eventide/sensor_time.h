// Two clocks that never mix: the camera's and the computer's.
#pragma once

#include <chrono>
#include <cstdint>

namespace eventide {

/// The camera's own clock. Only its data tell it, so it has no now(). Epoch: whatever the stream
/// says (microseconds since the camera's start, or since 1970).
struct SensorClock {
    using rep = std::int64_t;
    using period = std::micro;
    using duration = std::chrono::duration<rep, period>;
    using time_point = std::chrono::time_point<SensorClock>;
    static constexpr bool is_steady = true;
};

using SensorTime = SensorClock::time_point;
using SensorDuration = SensorClock::duration;
using HostTime = std::chrono::steady_clock::time_point;

constexpr SensorTime from_us(std::int64_t us) {
    return SensorTime{SensorDuration{us}};
}
constexpr std::int64_t to_us(SensorTime t) {
    return t.time_since_epoch().count();
}

/// The time span of an event window, (begin, end]: begin < t <= end.
struct Window {
    SensorTime begin, end;

    constexpr SensorDuration width() const { return end - begin; }
    friend constexpr bool operator==(const Window&, const Window&) = default;
};

}  // namespace eventide
