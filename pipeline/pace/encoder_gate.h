// Before the encoder: event windows go on when it can take them in time, until then they wait as
// one.
#pragma once

#include "pipeline/pace/latency_keeper.h"
#include "pipeline/pace/window_merger.h"

#include <cstddef>
#include <cstdint>

namespace eventide {

struct EncoderGateSettings {
    std::size_t most = 3;  ///< windows with or before the encoder
    /// In a merged window: bounds memory as SlicerSettings::max_events does for one that is cut.
    std::uint64_t most_events = std::uint64_t{1} << 24;
    bool new_state_after_gaps = false;
};

/// Bin thread. `lent()` is how many windows the encoder has or will have;
/// `hand_on(event window)` gives it one more, and waits where there is no room.
template <typename Lent, typename HandOn>
class EncoderGate {
public:
    EncoderGate(LatencyKeeper& keeper, const EncoderGateSettings& settings, Lent lent,
                HandOn hand_on)
        : keeper_(keeper),
          settings_(settings),
          merger_(settings.most_events),
          lent_(lent),
          hand_on_(hand_on) {}

    /// One more window, in order.
    void take(const CutWindow& event_window) {
        if (!keeper_.is_bound()) return hand_on_(event_window);
        keeper_.adapt(lent_());
        if (!merger_.takes(event_window, settings_.new_state_after_gaps)) flush();
        if (merger_.empty() && is_open()) return hand_on_(event_window);
        merged_ += merger_.empty() ? 0 : 1;
        merger_.add(event_window);
        look_again();
    }

    /// Time has passed: what waits may go on.
    void look_again() {
        if (!merger_.empty() && is_open()) hand_on_(merger_.take());
    }

    /// What waits goes on, whenever the encoder takes it.
    void flush() {
        if (!merger_.empty()) hand_on_(merger_.take());
    }

    std::uint64_t merged() const { return merged_; }  ///< windows that became one with another

private:
    bool is_open() const {
        const std::size_t lent = lent_();
        return lent < settings_.most && keeper_.hands_on(lent);
    }

    LatencyKeeper& keeper_;
    const EncoderGateSettings settings_;
    WindowMerger merger_;
    Lent lent_;
    HandOn hand_on_;
    std::uint64_t merged_ = 0;
};

}  // namespace eventide
