// What a frame says of itself beside its pixels.
#pragma once

#include <eventide/frame.h>

namespace eventide {

/// `into` shows the instant of `from`: time, event window, number, arrival and gap.
inline void copy_stamp(const Frame& from, Frame& into) {
    into.t = from.t;
    into.window = from.window;
    into.index = from.index;
    into.events = from.events;
    into.arrived = from.arrived;
    into.gap_before = from.gap_before;
}

}  // namespace eventide
