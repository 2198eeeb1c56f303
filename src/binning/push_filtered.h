// Events through a filter into a slicer.
#pragma once

#include "src/binning/slicer.h"

#include <cstddef>
#include <vector>

namespace eventide {

// A filter has process(), release(), flush(), known_until() and held(), as EventFilter. Each
// function returns how many events were left out.

/// Pushes what comes out of `filter` for `events`, in place; those left out tell the time all the
/// same.
template <typename Filter>
std::size_t push_filtered(Slicer& slicer, std::vector<Event>& events, Filter& filter,
                          HostTime arrived = {}) {
    if (events.empty()) {
        slicer.push(events, arrived);
        return 0;
    }
    const SensorTime newest = events.back().t;
    const std::size_t before = events.size() + filter.held();
    slicer.hear(events);
    filter.process(events);
    slicer.push(events, arrived);
    slicer.advance(filter.known_until(newest), arrived);
    return before - events.size() - filter.held();
}

/// The stream's clock says `now`: no event before it will come any more. `room` is overwritten.
template <typename Filter>
std::size_t advance_filtered(Slicer& slicer, SensorTime now, Filter& filter,
                             std::vector<Event>& room, HostTime arrived = {}) {
    const std::size_t before = filter.held();
    room.clear();
    filter.release(now, room);
    if (!room.empty()) slicer.push(room, arrived);
    slicer.advance(filter.known_until(now), arrived);
    return before - room.size() - filter.held();
}

/// Nothing more will come.
template <typename Filter>
std::size_t flush_filtered(Slicer& slicer, Filter& filter, std::vector<Event>& room,
                           HostTime arrived = {}) {
    const std::size_t before = filter.held();
    room.clear();
    filter.flush(room);
    if (!room.empty()) slicer.push(room, arrived);
    return before - room.size();
}

}  // namespace eventide
