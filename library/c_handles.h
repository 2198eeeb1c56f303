// What stands behind the handles of the C interface.
#pragma once

#include <eventide/eventide.h>
#include <eventide/pipeline.h>
#include <eventide/reconstructor.h>
#include <eventide/writer.h>

#include <cstddef>
#include <memory>
#include <vector>

struct eventide_reconstructor {
    eventide::Reconstructor it;
    eventide::Frame frame{};
    std::vector<eventide::Event> events{};
    std::vector<std::byte> state{};
};

/// The frame that a reconstructor made last, where C sees it.
inline eventide_status show_frame(const eventide_reconstructor& reconstructor,
                                  eventide_frame& frame) {
    const eventide::Frame& from = reconstructor.frame;
    frame.t = eventide::to_us(from.t);
    frame.window_begin = eventide::to_us(from.window.begin);
    frame.window_end = eventide::to_us(from.window.end);
    frame.index = from.index;
    frame.events = from.events;
    frame.width = from.intensity.width();
    frame.height = from.intensity.height();
    frame.intensity = from.intensity.values().data();
    frame.sigma = from.sigma.empty() ? nullptr : from.sigma.values().data();
    frame.gap_before = from.gap_before ? 1 : 0;
    return EVENTIDE_OK;
}

struct eventide_source {
    std::unique_ptr<eventide::EventSource> it;
    eventide::Batch batch{};
    std::vector<eventide_event> events{};
};

struct eventide_writer {
    eventide::EventWriter it;
    std::vector<eventide::Event> events{};
};
