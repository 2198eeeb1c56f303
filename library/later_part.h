// What follows a jump in a recording, without what lies before the time that was asked for.
#pragma once

#include <eventide/event.h>
#include <eventide/sensor_time.h>

#include <algorithm>
#include <optional>
#include <vector>

namespace eventide {

/// Formats can jump to some place before a time only, many to the beginning alone. Once an event of
/// that time or a later one has come, everything is passed on: what is earlier then is of a new
/// clock.
class LaterPart {
public:
    void begin(SensorTime t) { begin_ = t; }

    /// Leaves out of `batch`, whose images came before its events, what is too early.
    void take(Batch& batch) {
        if (!begin_) return;
        const auto is_early = [t = *begin_](const auto& it) { return it.t < t; };
        const auto first = std::ranges::find_if_not(batch.events, is_early);
        if (first != batch.events.end()) begin_.reset();
        batch.events.erase(batch.events.begin(), first);
        batch.image_places.clear();
        std::erase_if(batch.images, is_early);
        std::erase_if(batch.imu, is_early);
        std::erase_if(batch.triggers, is_early);
    }

private:
    std::optional<SensorTime> begin_;  // none: nothing is too early any more
};

}  // namespace eventide
