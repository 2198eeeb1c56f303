// Which frames a live line renders when it cannot render all: latency stays, frames go.
#pragma once

#include "src/core/sensor_time.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace eventide {

/// Learns what a frame costs and how often event frames come, and leaves out frames evenly, each
/// time the older ones before a newer one, so that all due frames are done before the next event
/// frame comes. Where that was too hopeful and event frames pile up, the oldest frames are left
/// out until they do not. Render thread.
class FrameShedder {
public:
    /// `waits_at_most` event frames may wait: the pool's size less what is in work.
    explicit FrameShedder(std::size_t waits_at_most)
        : waits_at_most_(std::max<std::size_t>(waits_at_most, 1)) {}

    /// An event frame is here and `due` frames with it.
    void open(std::uint64_t due, HostTime now) {
        if (opened_before_) learn(interval_s_, seconds(now - opened_));
        opened_ = now;
        opened_before_ = true;
        due_ = due;
        done_ = 0;
        affordable_ = due;
        if (frame_s_ > 0 && interval_s_ > 0) {
            const double fit = kShareOfTime * interval_s_ / frame_s_;
            if (fit < double(due)) affordable_ = std::max<std::uint64_t>(1, std::uint64_t(fit));
        }
    }

    /// Asked once for each due frame, oldest first. `waiting`: event frames behind this one.
    bool keeps_next(std::size_t waiting) {
        const std::uint64_t i = done_++;
        if (waiting >= waits_at_most_) return false;
        // The last of each group of due / affordable frames: the newest is always among them.
        return (i + 1) * affordable_ / due_ != i * affordable_ / due_;
    }

    /// What a kept frame took, rendering and writing.
    void took(HostTime::duration work) { learn(frame_s_, seconds(work)); }

private:
    static constexpr double kShareOfTime = 0.9;  // leaves some for what is not frames
    static constexpr double kNewShare = 0.1;     // of a new sample in the running mean

    static double seconds(HostTime::duration d) { return std::chrono::duration<double>(d).count(); }
    static void learn(double& mean, double sample) {
        mean = mean > 0 ? mean + kNewShare * (sample - mean) : sample;
    }

    std::size_t waits_at_most_;
    double frame_s_ = 0, interval_s_ = 0;  // running means; 0 where nothing is known yet
    HostTime opened_{};
    bool opened_before_ = false;
    std::uint64_t due_ = 0, done_ = 0, affordable_ = 0;
};

}  // namespace eventide
