// How far a device's clock is ahead of the host's, seen through packets that arrive more or less
// late.
#pragma once

#include <algorithm>
#include <cstdint>

namespace eventide {

/// The least delay a packet ever had bounds what any packet can tell: no time later than latest().
/// All in us.
class HostReference {
public:
    void begin(std::int64_t time, std::int64_t arrived) {
        ahead_ = double(time - arrived);
        seen_ = arrived;
    }
    /// The latest time of the device that a packet which arrives now can hold.
    std::int64_t latest(std::int64_t arrived) const { return arrived + std::int64_t(ahead_); }

    /// A packet with this newest time arrived. Where the time itself is in doubt it moves the
    /// reference no faster than two clocks drift apart.
    void see(std::int64_t time, std::int64_t arrived, bool in_doubt) {
        const double drift = kDrift * double(std::max<std::int64_t>(arrived - seen_, 0));
        seen_ = arrived;
        ahead_ -= drift;  // the device may be the slower of the two
        const double earlier = double(time - arrived) - ahead_;
        if (earlier > 0) ahead_ += in_doubt ? std::min(earlier, 2 * drift) : earlier;
    }

private:
    static constexpr double kDrift = 200e-6;  ///< of two crystals, each good to 100 ppm

    double ahead_ = 0;
    std::int64_t seen_ = 0;
};

}  // namespace eventide
