// Time as iniVation's words tell it: some low bits, wraps, and resets (drivers-and-formats.md A.9,
// A.12).
#pragma once

#include "src/core/damage.h"
#include "src/core/sensor_time.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

namespace eventide {

/// 64 bits, so the 2^31 us overflow of older readers does not exist. A reset sets the device to
/// zero; here time goes on. A word tells the low `kBits` bits: 15 of DAVIS and DVXplorer, 14 of
/// DVS128.
template <int kBits>
class IniVationClock {
public:
    static constexpr std::int64_t kWrapUs = 1 << kBits;

    std::int64_t us() const { return time_; }
    SensorTime now() const { return from_us(time_); }
    /// A word told the time since the start or the last loss.
    bool is_known() const { return known_; }

    /// False where the event that comes with the word has to be left out.
    bool timestamp(std::uint16_t low, Damage& damage) {
        if (expected_) catch_up(wrap_add_ + low);
        return move_to(wrap_add_ + low, damage);
    }
    void wrap(std::uint16_t wraps, Damage& damage) {
        if (wraps == 0) return damage.count(DamageReason::bad_record);
        wrap_add_ += kWrapUs * wraps;
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

    // For loops that keep the time in a register while only timestamps come, then hand it back.

    /// Nothing but the word itself decides what the next timestamp means.
    bool is_settled() const { return known_ && !expected_; }
    std::int64_t wrap_add() const { return wrap_add_; }  ///< us; plus a word's low bits: its time
    void move_on(std::int64_t us) { time_ = us; }        ///< settled only, and not backwards

private:
    bool move_to(std::int64_t time, Damage& damage) {
        if (time < time_) {
            damage.count(DamageReason::time_backwards);
            return false;
        }
        time_ = time;
        return known_ = true;
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
