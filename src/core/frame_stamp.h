// What a frame says of itself beside its pixels.
#pragma once

#include "src/core/frame_data.h"

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

/// `into` is frame `index` of the clock, at t in that event window. When its events came in is left
/// as it is: with lookahead those of later windows count.
inline void stamp_frame(SensorTime t, std::uint64_t index, const WindowStamp& window, Frame& into) {
    into.t = t;
    into.index = index;
    into.window = window.window;
    into.events = window.events;
    into.gap_before = window.gap_before;
}

/// A gap before an event window that no frame shows (none was due, or all were left out) is told by
/// the frames of the next window that has any. One thread.
class GapCarrier {
public:
    /// A window's frames come next. Whether they tell of a gap.
    bool open(bool gap_before) noexcept { return untold_ = untold_ || gap_before; }
    /// One of them was made.
    void tell() noexcept { untold_ = false; }

private:
    bool untold_ = false;
};

}  // namespace eventide
