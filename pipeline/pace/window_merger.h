// Event windows that wait for the encoder, as one.
#pragma once

#include "src/core/frame_data.h"

#include <cstdint>
#include <vector>

namespace eventide {

struct CutWindow : EventWindow {
    std::uint64_t images = 0;  ///< that the stream had given when it was cut

    CutWindow() = default;
    CutWindow(const EventWindow& cut, std::uint64_t known = 0) : EventWindow{cut}, images{known} {}
};

/// Keeps the events of consecutive windows; the window of all of them begins with the first and
/// ends with the last. Bin thread.
class WindowMerger {
public:
    /// At most so many events in one.
    explicit WindowMerger(std::uint64_t most_events) : most_events_(most_events) {}

    bool empty() const { return windows_ == 0; }

    /// Whether a window may become one with those kept: nothing is merged over a place where the
    /// network starts with a new state.
    bool takes(const EventWindow& event_window, bool new_state_after_gaps) const {
        if (empty()) return true;
        return !event_window.reset_before && !(event_window.gap_before && new_state_after_gaps) &&
               events_.size() + event_window.events.size() <= most_events_;
    }

    void add(const CutWindow& event_window) {
        if (empty()) {
            merged_ = event_window;
            events_.clear();
        }
        events_.insert(events_.end(), event_window.events.begin(), event_window.events.end());
        merged_.window.end = event_window.window.end;
        merged_.gap_before = merged_.gap_before || event_window.gap_before;
        merged_.arrived = event_window.arrived;
        merged_.images = event_window.images;
        ++windows_;
    }

    /// All that is kept, borrowed until the next add(); nothing is kept any more.
    CutWindow take() {
        merged_.events = events_;
        windows_ = 0;
        return merged_;
    }

private:
    std::uint64_t most_events_;
    std::vector<Event> events_;
    CutWindow merged_;
    std::uint64_t windows_ = 0;
};

}  // namespace eventide
