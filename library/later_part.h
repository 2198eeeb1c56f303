// What follows a jump in a recording, without what lies before the time that was asked for.
#pragma once

#include <eventide/event.h>
#include <eventide/sensor_time.h>

#include <algorithm>
#include <optional>
#include <vector>

namespace eventide {

/// Formats can jump to some place before a time only, many to the beginning alone. Once an event of
/// that time or a later one has come, all events are passed on: those that are earlier then come
/// after a clock reset. Images come behind the events of their time: early ones are left out until
/// then.
class LaterPart {
public:
    void begin(SensorTime t) {
        begin_ = t;
        has_begun_ = false;
    }

    /// Leaves out of `batch`, whose images came before its events, what is too early.
    void take(Batch& batch) {
        if (!begin_) return;
        const auto is_early = [t = *begin_](const auto& it) { return it.t < t; };
        if (!has_begun_) {
            const auto first = std::ranges::find_if_not(batch.events, is_early);
            has_begun_ = first != batch.events.end();
            batch.events.erase(batch.events.begin(), first);
        }
        std::erase_if(batch.images, is_early);
        if (std::ranges::any_of(batch.events, is_early)) return begin_.reset();
        std::erase_if(batch.imu, is_early);
        std::erase_if(batch.triggers, is_early);
    }

private:
    std::optional<SensorTime> begin_;  // none: nothing is too early any more
    bool has_begun_ = false;           // an event of that time or a later one has come
};

}  // namespace eventide
