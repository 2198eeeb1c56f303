// The sensor's time as ROS time.
#pragma once

#include "pipeline/ros2/ros2_name.h"
#include "src/core/frame_data.h"

#include <cstdint>
#include <optional>

namespace eventide {

/// Stamps are the sensor's time plus an offset: with StampRule::arrival such that the end of the
/// first frame's event window is when the packet that ended it arrived, by the system's clock. Of
/// a live source the offset then follows the packets with the least delay, as two clocks never run
/// alike, by at most kMaxSlope; of a recording it stays. Stamps always rise, also where the
/// camera's clock begins anew: that sets a new offset. So does a system's clock that is set, from
/// one frame to the next by kStep or more; where it is set back, stamps go back with it.
class StampClock {
public:
    static constexpr double kMaxSlope = 1e-3;  ///< seconds of correction for each second
    static constexpr double kDrift = 200e-6;   ///< of two crystals, each good to 100 ppm
    static constexpr SensorDuration kStep{500'000};
    /// Times from here on count from 1970: 2001-09-09.
    static constexpr SensorTime kSince1970{SensorDuration{1'000'000'000'000'000}};

    StampClock(StampRule rule, bool live) : rule_{rule}, live_{live} {}

    /// Of the frames to come: event windows that came between a frame's own and Frame::arrived.
    void set_lookahead(int windows) { lookahead_ = windows; }

    /// In us since 1970. `system_ahead`: what the system's clock shows now, since 1970, less that
    /// of Frame::arrived.
    std::int64_t stamp_us(const Frame& frame, SensorDuration system_ahead);

    /// Whether the last stamp has an offset other than the one before: at the first, and where the
    /// camera's clock began anew or the system's was set. What follows the drift does not count.
    bool is_set_anew() const { return set_anew_; }
    double offset_us() const { return offset_us_; }

private:
    double seen_offset_us(const Frame& frame, std::int64_t arrived_us) const;
    void set(const Frame& frame, std::int64_t arrived_us);
    void follow(const Frame& frame, std::int64_t arrived_us);

    StampRule rule_;
    bool live_;
    int lookahead_ = 0;
    bool shifted_ = false, set_anew_ = false;
    double offset_us_ = 0, least_us_ = 0;  // least_us_: the least delay seen, less the drift
    std::int64_t arrived_us_ = 0;          // of the last frame
    SensorDuration system_ahead_{0};       // at the last frame
    std::optional<SensorTime> t_;          // of the last frame
    std::int64_t stamp_us_ = 0;
};

}  // namespace eventide
