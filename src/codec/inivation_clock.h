// Time as iniVation's 16-bit words tell it: the low 15 bits, wraps, and resets
// (drivers-and-formats.md A.9).
#pragma once

#include "src/core/damage.h"
#include "src/core/sensor_time.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

namespace eventide {

/// 64 bits, so the 2^31 us overflow of older readers does not exist. A reset sets the device to
/// zero; here time goes on.
class IniVationClock {
public:
    static constexpr std::int64_t kWrapUs = 1 << 15;

    std::int64_t us() const { return time_; }
    SensorTime now() const { return from_us(time_); }
    /// A word told the time since the start or the last loss.
    bool is_known() const { return known_; }

    void timestamp(std::uint16_t low15, Damage& damage) {
        if (expected_) catch_up(wrap_add_ + low15);
        move_to(wrap_add_ + low15, damage);
    }
    void wrap(std::uint16_t multiplier, Damage& damage) {
        if (multiplier == 0) return damage.count(DamageReason::bad_record);
        wrap_add_ += kWrapUs * multiplier;
        if (expected_) catch_up(wrap_add_);
        move_to(wrap_add_, damage);
    }
    /// The device counts from zero again, the stream goes on (after an unplugging, by the host's
    /// clock).
    void reset() {
        wrap_add_ = time_ = std::max(time_, expected_.value_or(time_));
        known_ = true;
        expected_.reset();
    }
    /// Bytes were lost: nothing has a time until a word tells it again.
    void forget() { known_ = false; }
    /// See Parser::expect_passed: the next timestamp is the one nearest to this guess.
    void expect_passed(SensorDuration passed) { expected_ = time_ + passed.count(); }

private:
    void move_to(std::int64_t time, Damage& damage) {
        if (time < time_) return damage.count(DamageReason::time_backwards);
        time_ = time;
        known_ = true;
    }
    /// Whole wraps may be missing: adds as many as bring `candidate` nearest to the expected time.
    void catch_up(std::int64_t candidate) {
        const double wraps = std::round(double(*expected_ - candidate) / double(kWrapUs));
        if (wraps > 0) wrap_add_ += std::int64_t(wraps) * kWrapUs;
        expected_.reset();
    }

    std::int64_t wrap_add_ = 0, time_ = 0;
    bool known_ = false;
    std::optional<std::int64_t> expected_;
};

}  // namespace eventide
