// The sensor's time as ROS time.
#include "pipeline/ros2/stamp_clock.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace eventide {

/// The frame's window ended `lookahead_` windows before the packet came: they are taken to be as
/// long as this one.
double StampClock::seen_offset_us(const Frame& frame, std::int64_t arrived_us) const {
    const SensorTime told = frame.window.end + lookahead_ * frame.window.width();
    return double(arrived_us - to_us(told));
}

void StampClock::set(const Frame& frame, std::int64_t arrived_us) {
    shifted_ =
        rule_ == StampRule::arrival || (rule_ == StampRule::automatic && frame.t < kSince1970);
    offset_us_ = least_us_ = shifted_ ? seen_offset_us(frame, arrived_us) : 0;
    set_anew_ = true;
}

void StampClock::follow(const Frame& frame, std::int64_t arrived_us) {
    const double passed = double(std::max<std::int64_t>(arrived_us - arrived_us_, 0));
    least_us_ = std::min(least_us_ + kDrift * passed, seen_offset_us(frame, arrived_us));
    const double most = kMaxSlope * passed;
    offset_us_ += std::clamp(least_us_ - offset_us_, -most, most);
}

std::int64_t StampClock::stamp_us(const Frame& frame, SensorDuration system_ahead) {
    using std::chrono::duration_cast;
    const auto arrived = duration_cast<SensorDuration>(frame.arrived.time_since_epoch());
    const std::int64_t arrived_us = (arrived + system_ahead).count();
    const bool first = !t_, follows = shifted_ && live_;
    const SensorDuration step = system_ahead - system_ahead_;
    const bool is_set = !first && follows && (step >= kStep || step <= -kStep);
    set_anew_ = false;
    if (first || is_set || frame.t <= *t_)
        set(frame, arrived_us);
    else if (follows)
        follow(frame, arrived_us);
    arrived_us_ = arrived_us;
    system_ahead_ = system_ahead;
    t_ = frame.t;
    const std::int64_t stamp = to_us(frame.t) + std::llround(offset_us_);
    const bool may_fall = first || (is_set && step < step.zero());
    stamp_us_ = may_fall ? stamp : std::max(stamp, stamp_us_ + 1);
    return stamp_us_;
}

}  // namespace eventide
