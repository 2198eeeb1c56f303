// Silence -> the end of a wide empty window.
#include "src/binning/silence_tracker.h"

#include <algorithm>

namespace eventide {

void SilenceTracker::restore(int empty_windows, SensorTime newest) {
    empty_windows_ = std::min(empty_windows, silent_windows_);
    newest_ = newest;
    clocks_heard_ = clocks_given_ = 0;
    pauses_.clear();
}

void SilenceTracker::hear_anew() {
    newest_ = SensorTime::min();
    ++clocks_heard_;
}

void SilenceTracker::begin_anew() {
    ++clocks_given_;
    empty_windows_ = 0;
}

void SilenceTracker::begin_at(SensorTime begin) {
    newest_ = std::max(newest_, begin);
}

/// The first time after `edge` that was seen, where it is far from it; else `edge`.
SensorTime SilenceTracker::seen_after(SensorTime edge) const {
    for (const Pause& pause : pauses_)
        if (pause.clock == clocks_given_ && pause.begin <= edge && edge < pause.end)
            return pause.end;
    return edge;
}

SensorTime SilenceTracker::widened(SensorTime edge, SensorTime quiet_until) const {
    if (empty_windows_ < silent_windows_) return edge;
    const SensorTime upto = std::min(quiet_until, seen_after(edge) - SensorDuration{1});
    const auto windows = (upto - edge) / width_ - kMaxLookahead;
    return windows > 0 ? edge + windows * width_ : edge;
}

void SilenceTracker::end_window(bool empty) {
    empty_windows_ = empty ? std::min(empty_windows_ + 1, silent_windows_) : 0;
}

void SilenceTracker::forget_pauses_until(SensorTime t) {
    std::erase_if(pauses_, [this, t](const Pause& pause) {
        return pause.clock < clocks_given_ || (pause.clock == clocks_given_ && pause.end <= t);
    });
}

}  // namespace eventide
