// Silence, which is time without events: how far one empty window may reach into it.
#pragma once

#include "src/core/sensor_limits.h"
#include "src/core/sensor_time.h"

#include <cstdint>
#include <vector>

namespace eventide {

/// Whole empty windows in a long silence become one (SlicerSettings::silent_windows), but for the
/// last, which frames of the wide one read:
///
///     windows    (  ](  ] .. (  ](                         ](  ](  ](  x ]
///                silent_windows       one wide window      kMaxLookahead, and the event's
///
/// Two times that the stream told one after the other say how far a silence goes, whatever else is
/// known by now: so the windows are the same however the stream is split into calls.
class SilenceTracker {
public:
    /// `width`: of a window without events. The first `silent_windows` of a silence come one by
    /// one.
    void set_windows(SensorDuration width, int silent_windows) {
        width_ = width;
        silent_windows_ = silent_windows;
    }

    /// As constructed, for windows as before.
    void reset() { restore(0, SensorTime::min()); }

    /// Goes on after so many empty windows in a row, in a stream that is at `newest`.
    void restore(int empty_windows, SensorTime newest);

    /// The first window begins here.
    void begin_at(SensorTime begin);

    /// The stream is at t: an event, though a filter leaves it out, or its clock says so.
    void see(SensorTime t) {
        // Anything shorter leaves no whole window but those that come one by one anyway.
        if (newest_ != SensorTime::min() && t > newest_ + (kMaxLookahead + 1) * width_)
            pauses_.push_back({clocks_heard_, newest_, t});
        newest_ = t;
    }
    SensorTime newest() const { return newest_; }  ///< seen last; SensorTime::min(): nothing yet
    /// Clock reset: what is seen from now on is of the new clock.
    void hear_anew();

    /// Where a window ends that would end at `edge`, when no event is known before `quiet_until`.
    SensorTime widened(SensorTime edge, SensorTime quiet_until) const;

    void end_window(bool empty);
    /// Windows begin after `t` from now on, or are of a later clock.
    void forget_pauses_until(SensorTime t);
    /// The windows, too, have come to a clock reset: the next one is of the clock after it.
    void begin_anew();

    int empty_windows() const { return empty_windows_; }  ///< in a row, silent_windows at most

private:
    /// Between two times that were seen one after the other, long enough for a wide window.
    struct Pause {
        std::uint64_t clock;
        SensorTime begin, end;
    };
    SensorTime seen_after(SensorTime edge) const;

    SensorDuration width_{1};
    int silent_windows_ = 1, empty_windows_ = 0;
    SensorTime newest_ = SensorTime::min();
    std::uint64_t clocks_heard_ = 0, clocks_given_ = 0;  // resets seen; of windows
    std::vector<Pause> pauses_;  // that may concern the open window or later ones
};

}  // namespace eventide
