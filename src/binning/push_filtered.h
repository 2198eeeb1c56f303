// Events through a filter into a slicer.
#pragma once

#include "src/binning/slicer.h"

#include <cstddef>
#include <vector>

namespace eventide {

/// Pushes what `filter` leaves of `events`, in place; those left out tell the time all the same.
/// Returns how many were left out. Filter: has process(std::vector<Event>&).
template <typename Filter>
std::size_t push_filtered(Slicer& slicer, std::vector<Event>& events, Filter& filter,
                          HostTime arrived = {}) {
    if (events.empty()) {
        slicer.push(events, arrived);
        return 0;
    }
    const SensorTime newest = events.back().t;
    const std::size_t before = events.size();
    slicer.hear(events);
    filter.process(events);
    slicer.push(events, arrived);
    slicer.advance(newest, arrived);
    return before - events.size();
}

}  // namespace eventide
