// The 32-bit microseconds of AEDAT 1 and 2 as one time line, through wraps, damage and resets.
#pragma once

#include "src/core/damage.h"

#include <cstdint>
#include <optional>

namespace eventide {

/// One record of AEDAT 1 or 2.
struct AedatRecord {
    std::uint32_t address = 0;
    std::int32_t stamp = 0;  ///< us
};

/// The formats mark neither wraps nor resets, so both are told from damage by what follows:
/// - a stamp that falls from near 2^31 to near zero, or overflows to negative, wrapped;
/// - a leap of more than kLongestSilence is believed when the next record confirms it, else that
///   one record is damage (a flipped bit would otherwise put all that follows in the past);
/// - a step back is jitter or damage, and the user's business, until kResetRecords records in a row
///   go on from there: then the clock was reset or files were joined, and time goes on from where
///   it was.
class AedatTimeline {
public:
    static constexpr std::int64_t kLongestSilence = 60'000'000;  // us
    static constexpr std::int64_t kJitter = 10'000;              // us, no reset is as small
    static constexpr int kResetRecords = 32;

    /// Calls take(record, t) with the time in us for this record, and the one held back before it;
    /// reset(t) before a record after a reset. t may lie before an earlier one.
    template <typename Take, typename Reset>
    void push(const AedatRecord& record, Damage& damage, Take&& take, Reset&& reset) {
        const std::int64_t step = step_to(record.stamp);
        if (held_ || step > kLongestSilence) {
            if (!settle_held(record, step, damage, take)) return;
        }
        if (started_ && step < 0 && goes_on_in_the_past(record.stamp, step)) {
            last_stamp_ = record.stamp;
            steps_back_ = 0;
            reset(last_);
        }
        place(record, take);
    }

    /// The stream ended: nothing can contradict the record held back.
    template <typename Take>
    void finish(Take&& take) {
        if (held_) place(*held_, take);
        held_.reset();
    }

    void resync() { *this = {}; }

    std::optional<std::int64_t> newest() const {
        return started_ ? std::optional(last_) : std::nullopt;
    }

private:
    /// us from the newest time to this stamp.
    std::int64_t step_to(std::int32_t stamp) const {
        if (!started_) return 0;
        const auto step =
            std::int64_t(std::int32_t(std::uint32_t(stamp) - std::uint32_t(last_stamp_)));
        const bool wrapped_31_bits =
            step < -(std::int64_t(1) << 30) && stamp >= 0 && last_stamp_ >= 0;
        return wrapped_31_bits ? step + (std::int64_t(1) << 31) : step;
    }

    /// False when the record itself is now held back.
    template <typename Take>
    bool settle_held(const AedatRecord& record, std::int64_t step, Damage& damage, Take& take) {
        if (step <= kLongestSilence) {
            damage.count(DamageReason::bad_record);
            held_.reset();
            return true;
        }
        if (held_) {
            const auto between = std::int64_t(record.stamp) - held_->stamp;
            if (between >= 0 && between <= kLongestSilence) {
                place(*held_, take);
                held_.reset();
                return true;
            }
            damage.count(DamageReason::bad_record);
        }
        held_ = record;
        return false;
    }

    bool goes_on_in_the_past(std::int32_t stamp, std::int64_t step) {
        if (step >= -kJitter) return false;
        const bool goes_on = steps_back_ > 0 && stamp >= past_stamp_ &&
                             std::int64_t(stamp) - past_stamp_ <= kLongestSilence;
        steps_back_ = goes_on ? steps_back_ + 1 : 1;
        past_stamp_ = stamp;
        return steps_back_ > kResetRecords;
    }

    template <typename Take>
    void place(const AedatRecord& record, Take& take) {
        if (!started_) {
            started_ = true;
            last_ = last_stamp_ = record.stamp;
        }
        const std::int64_t step = step_to(record.stamp);
        take(record, last_ + step);
        if (step < 0) return;
        last_ += step;
        last_stamp_ = record.stamp;
        steps_back_ = 0;
    }

    bool started_ = false;
    std::int64_t last_ = 0;        ///< us, the newest
    std::int32_t last_stamp_ = 0;  ///< as it stood in the record
    std::optional<AedatRecord> held_;
    int steps_back_ = 0;
    std::int32_t past_stamp_ = 0;
};

}  // namespace eventide
