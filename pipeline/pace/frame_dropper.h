// Which frames a live line renders when it cannot render all: latency stays, frames go.
#pragma once

#include "pipeline/frame_clock.h"
#include "src/core/sensor_time.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace eventide {

/// Learns what a frame costs and how often event windows come, and leaves out frames evenly, each
/// time the older ones before a newer one, so that all due frames are done before the next event
/// window comes, and in time where latency has a bound. Where that was too hopeful and event
/// windows pile up, the oldest frames are left out until they do not. Render thread.
class FrameDropper {
public:
    /// `waits_at_most` event windows may wait: the pool's size less what is in work.
    explicit FrameDropper(std::size_t waits_at_most)
        : waits_at_most_(std::max<std::size_t>(waits_at_most, 1)) {}

    /// What one event window asks for.
    struct Due {
        std::uint64_t first = 0, frames = 0;  ///< numbers on the frame clock
        unsigned halvings = 0;                ///< of the rate: every 2^n-th number is a candidate
        /// How many of them come in time where latency has a bound (LatencyKeeper).
        std::optional<double> in_time{};
    };

    /// An event window is here and frames with it.
    void open(const Due& due, HostTime now) {
        if (opened_before_) learn(interval_s_, seconds(now - opened_));
        opened_ = now;
        opened_before_ = true;
        next_ = due.first;
        halvings_ = due.halvings;
        candidates_ =
            kept_before(due.first + due.frames, halvings_) - kept_before(due.first, halvings_);
        done_ = 0;
        affordable_ = candidates_;
        if (frame_s_ > 0 && interval_s_ > 0) {
            const double fit = kShareOfTime * interval_s_ / frame_s_;
            if (fit < double(candidates_))
                affordable_ = std::max<std::uint64_t>(1, std::uint64_t(fit));
        }
        if (due.in_time && *due.in_time < double(affordable_))
            affordable_ = std::uint64_t(*due.in_time);
    }

    /// Asked once for each due frame, oldest first. `waiting`: event windows behind this one.
    bool keeps_next(std::size_t waiting) {
        if (!is_kept(next_++, halvings_)) return false;
        const std::uint64_t i = done_++;
        if (waiting >= waits_at_most_) return false;
        // All would be late: the newest is rendered where nothing newer is there.
        if (affordable_ == 0) return waiting == 0 && i + 1 == candidates_;
        // The last of each group of candidates / affordable frames: the newest is always among
        // them.
        return (i + 1) * affordable_ / candidates_ != i * affordable_ / candidates_;
    }

    /// What a kept frame took, rendering and writing.
    void took(HostTime::duration work) { learn(frame_s_, seconds(work)); }

private:
    // Leaves some time for what is not frames. More renders more frames, and has less room for slow
    // ones before event windows pile up.
    static constexpr double kShareOfTime = 0.9;
    // Of a new sample in the running mean: one slow frame hardly counts, a change is learned within
    // some twenty.
    static constexpr double kNewShare = 0.1;

    static double seconds(HostTime::duration d) { return std::chrono::duration<double>(d).count(); }
    static void learn(double& mean, double sample) {
        mean = mean > 0 ? mean + kNewShare * (sample - mean) : sample;
    }

    std::size_t waits_at_most_;
    double frame_s_ = 0, interval_s_ = 0;  // running means; 0 where nothing is known yet
    HostTime opened_{};
    bool opened_before_ = false;
    unsigned halvings_ = 0;
    std::uint64_t next_ = 0;                                    // number of the next due frame
    std::uint64_t candidates_ = 0, done_ = 0, affordable_ = 0;  // of the open event window
};

}  // namespace eventide
