// The beginning of a pipeline over a toy source, fed by hand.
#pragma once

#include "pipeline/event_windows.h"
#include "tests/support/toy_stages.h"

#include <chrono>
#include <cstdint>
#include <utility>
#include <vector>

namespace eventide::test {

using Edges = std::vector<std::pair<std::int64_t, std::int64_t>>;

struct Beginning {
    explicit Beginning(bool live, std::int64_t width_us = 10, EventFilter* filter = nullptr,
                       DataObserver* observer = nullptr)
        : source({}, live), frames(source, settings(width_us), filter, observer, counters) {}

    static EventWindows::Settings settings(std::int64_t width_us) {
        EventWindows::Settings s;
        s.slicer.width = SensorDuration{width_us};
        s.silence_margin = SensorDuration{100};
        return s;
    }
    void give(const std::vector<std::byte>& bytes, std::int64_t host_us, bool gap = false) {
        RawPacket packet;
        packet.bytes = bytes;
        packet.arrived = HostTime{std::chrono::microseconds{host_us}};
        packet.gap_before = gap;
        frames.take(packet);
        take();
    }
    void finish(EventWindows::End end = EventWindows::End::of_source) {
        frames.finish(end);
        take();
    }
    void take() {
        for (EventWindow event_window; frames.next(event_window);) {
            edges.emplace_back(to_us(event_window.window.begin), to_us(event_window.window.end));
            gaps.push_back(event_window.gap_before);
            events += event_window.events.size();
            images.push_back(frames.images());
        }
    }

    Counters counters;
    ToySource source;
    EventWindows frames;
    Edges edges;
    std::vector<bool> gaps;
    std::vector<std::uint64_t> images;  // that each window knows
    std::size_t events = 0;             // in the windows
};

inline std::vector<std::byte> record(ToyKind kind, std::int64_t t_us) {
    std::vector<std::byte> bytes;
    append_record(bytes, kind, t_us);
    return bytes;
}

}  // namespace eventide::test
