// Slices as values, and streams to cut, for tests of the slicer.
#pragma once

#include "src/binning/slicer.h"

#include <ostream>
#include <random>
#include <utility>
#include <vector>

namespace eventide {

/// A slice that outlives the slicer's next call.
struct Kept {
    std::int64_t begin_us, end_us;
    std::vector<Event> events;
    bool gap, reset;
    friend bool operator==(const Kept&, const Kept&) = default;
};

inline void PrintTo(const Kept& slice, std::ostream* out) {
    *out << '(' << slice.begin_us << ", " << slice.end_us << "] " << slice.events.size()
         << " events" << (slice.gap ? " gap" : "") << (slice.reset ? " reset" : "");
}

inline Event at(std::int64_t t_us, int x = 0) {
    return {from_us(t_us), std::uint16_t(x), 0, Polarity::on};
}

inline void take(Slicer& slicer, std::vector<Kept>& into) {
    for (Slice slice; slicer.next(slice);)
        into.push_back({to_us(slice.window.begin),
                        to_us(slice.window.end),
                        {slice.events.begin(), slice.events.end()},
                        slice.gap_before,
                        slice.reset_before});
}

inline std::vector<Kept> slices_of(const SlicerSettings& settings, const std::vector<Event>& events,
                                   const std::vector<std::int64_t>& images = {}) {
    Slicer slicer(settings, 240, 180);
    std::vector<Kept> slices;
    for (const auto t : images) slicer.push_reference(from_us(t));
    slicer.push(events);
    take(slicer, slices);
    slicer.finish();
    take(slicer, slices);
    return slices;
}

using Edges = std::vector<std::pair<std::int64_t, std::int64_t>>;

inline Edges edges_of(const std::vector<Kept>& slices) {
    Edges edges;
    for (const Kept& slice : slices) edges.emplace_back(slice.begin_us, slice.end_us);
    return edges;
}

inline SlicerSettings by_duration(std::int64_t us) {
    SlicerSettings settings;
    settings.width = SensorDuration{us};
    return settings;
}

inline SlicerSettings by_count(std::uint64_t events, std::int64_t max_us = 1'000'000) {
    SlicerSettings settings;
    settings.rule = SliceRule::count;
    settings.events = events;
    settings.max_width = SensorDuration{max_us};
    return settings;
}

inline SlicerSettings by_reference(std::int64_t max_us, std::int64_t wait_us = 1000) {
    SlicerSettings settings;
    settings.rule = SliceRule::reference;
    settings.max_width = SensorDuration{max_us};
    settings.reference_wait = SensorDuration{wait_us};
    return settings;
}

inline SlicerSettings by_content(double events_per_pixel, std::int64_t max_us = 50'000) {
    SlicerSettings settings;
    settings.rule = SliceRule::content;
    settings.events_per_pixel = events_per_pixel;
    settings.max_width = SensorDuration{max_us};
    return settings;
}

/// Bursts, equal timestamps, pauses of many frames, and a clock reset.
inline std::vector<Event> eventful_stream(std::mt19937& rng) {
    std::vector<Event> events;
    std::int64_t t = 1'700'000'000'000'000;
    for (int i = 0; i < 4000; ++i) {
        if (i == 3000) t = 5000;
        const auto dice = rng() % 1000;
        t += dice < 300 ? 0 : dice < 990 ? rng() % 20 : dice < 997 ? rng() % 3000 : rng() % 100'000;
        events.push_back(at(t, i % 240));
    }
    return events;
}

}  // namespace eventide
