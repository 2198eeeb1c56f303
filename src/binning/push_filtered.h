// Events through a filter into a slicer.
#pragma once

#include "src/binning/slicer.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace eventide {

// A filter has process(), release(), flush(), known_until() and held(), as EventFilter. Each
// function returns how many events were left out.

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

/// Pushes what comes out of `filter` for `events` in order of time, in place; those left out tell
/// the time all the same.
template <typename Filter>
std::size_t push_in_order(Slicer& slicer, std::vector<Event>& events, Filter& filter,
                          HostTime arrived) {
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

/// The same where `events` may hold clock resets: the slicer must know of each, even where the
/// filter leaves out the events around it.
template <typename Filter>
std::size_t push_filtered(Slicer& slicer, std::vector<Event>& events, Filter& filter,
                          HostTime arrived = {}) {
    const auto is_anew = [&](const Event& a, const Event& b) {
        return slicer.is_new_clock(a.t, b.t);
    };
    auto end = std::ranges::adjacent_find(events, is_anew);
    if (end == events.end() && (events.empty() || !slicer.begins_anew(events.front().t)))
        return push_in_order(slicer, events, filter, arrived);
    std::size_t left_out = 0;
    std::vector<Event> part;
    for (auto from = events.begin(); from != events.end(); from = end) {
        end = std::adjacent_find(from, events.end(), is_anew);
        if (end != events.end()) ++end;
        if (slicer.begins_anew(from->t)) {
            left_out += flush_filtered(slicer, filter, part, arrived);  // of the clock before
            slicer.begin_anew(from->t);
        }
        part.assign(from, end);
        left_out += push_in_order(slicer, part, filter, arrived);
    }
    return left_out;
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

}  // namespace eventide
