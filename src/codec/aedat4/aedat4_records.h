// The content of AEDAT4 packets -> events, images, IMU samples, triggers.
#pragma once

#include "src/codec/aedat4/aedat4_flat.h"
#include "src/codec/event_validator.h"
#include "src/core/damage.h"
#include "src/core/event.h"

#include <cstdint>
#include <optional>

namespace eventide {

constexpr std::size_t kAedat4EventBytes = 16;

/// A time that goes back by more is where a trigger said that the clock was reset; by less, only
/// one that is no further behind the trigger.
constexpr std::int64_t kAedat4ResetUs = 1'000'000;

/// Beyond these (year 75,000) a time is damage; differences of such times do not overflow.
constexpr std::int64_t kAedat4LatestUs = std::int64_t(1) << 61;
constexpr bool is_aedat4_time(std::int64_t t_us) {
    return t_us >= -kAedat4LatestUs && t_us <= kAedat4LatestUs;
}

/// Each appends what a packet of its kind holds and counts what makes no sense. The result is the
/// newest time told; empty when there was none. `anew_us`: the clock was reset to that time, so
/// that the first event that goes back to it, far from those before, begins anew and empties it.
std::optional<std::int64_t> take_aedat4_events(const FlatTable& packet, EventValidator& validator,
                                               std::optional<std::int64_t>& anew_us, Batch& into,
                                               Damage& damage);
std::optional<std::int64_t> take_aedat4_image(const FlatTable& frame, const EventValidator& sensor,
                                              Batch& into, Damage& damage);
std::optional<std::int64_t> take_aedat4_imu(const FlatTable& packet, Batch& into, Damage& damage);
std::optional<std::int64_t> take_aedat4_triggers(const FlatTable& packet, Batch& into,
                                                 Damage& damage);

/// The trigger's number in the format; negative when the format has none for it.
int aedat4_trigger_number(const Trigger& trigger);

}  // namespace eventide
