// EventWindows as values, and streams to cut, for tests of the slicer.
#pragma once

#include "src/binning/slicer.h"

#include <ostream>
#include <random>
#include <utility>
#include <vector>

namespace eventide {

/// An event window that outlives the slicer's next call.
struct Kept {
    std::int64_t begin_us, end_us;
    std::vector<Event> events;
    bool gap, reset;
    friend bool operator==(const Kept&, const Kept&) = default;
};

inline void PrintTo(const Kept& event_window, std::ostream* out) {
    *out << '(' << event_window.begin_us << ", " << event_window.end_us << "] "
         << event_window.events.size() << " events" << (event_window.gap ? " gap" : "")
         << (event_window.reset ? " reset" : "");
}

inline Event at(std::int64_t t_us, int x = 0) {
    return {from_us(t_us), std::uint16_t(x), 0, Polarity::on};
}

inline void take(Slicer& slicer, std::vector<Kept>& into) {
    for (EventWindow event_window; slicer.next(event_window);)
        into.push_back({to_us(event_window.window.begin),
                        to_us(event_window.window.end),
                        {event_window.events.begin(), event_window.events.end()},
                        event_window.gap_before,
                        event_window.reset_before});
}

inline std::vector<Kept> event_windows_of(const SlicerSettings& settings,
                                          const std::vector<Event>& events,
                                          const std::vector<std::int64_t>& images = {}) {
    Slicer slicer(settings, 240, 180);
    std::vector<Kept> event_windows;
    for (const auto t : images) slicer.push_reference(from_us(t));
    slicer.push(events);
    take(slicer, event_windows);
    slicer.finish();
    take(slicer, event_windows);
    return event_windows;
}

using Edges = std::vector<std::pair<std::int64_t, std::int64_t>>;

inline Edges edges_of(const std::vector<Kept>& event_windows) {
    Edges edges;
    for (const Kept& event_window : event_windows)
        edges.emplace_back(event_window.begin_us, event_window.end_us);
    return edges;
}

inline SlicerSettings by_duration(std::int64_t us) {
    SlicerSettings settings;
    settings.width = SensorDuration{us};
    return settings;
}

inline SlicerSettings by_count(std::uint64_t events, std::int64_t max_us = 1'000'000) {
    SlicerSettings settings;
    settings.rule = WindowRule::count;
    settings.events = events;
    settings.max_width = SensorDuration{max_us};
    return settings;
}

inline SlicerSettings by_reference(std::int64_t max_us, std::int64_t wait_us = 1000) {
    SlicerSettings settings;
    settings.rule = WindowRule::reference;
    settings.max_width = SensorDuration{max_us};
    settings.reference_wait = SensorDuration{wait_us};
    return settings;
}

inline SlicerSettings by_content(double events_per_pixel, std::int64_t max_us = 50'000) {
    SlicerSettings settings;
    settings.rule = WindowRule::content;
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
