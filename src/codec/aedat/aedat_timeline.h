// The 32-bit microseconds of AEDAT 1 and 2 as one time line, through wraps, damage and resets.
#pragma once

#include "src/core/damage.h"

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace eventide {

/// One record of AEDAT 1 or 2.
struct AedatRecord {
    std::uint32_t address = 0;
    std::int32_t stamp = 0;  ///< us
};

/// The formats mark neither wraps nor resets, so both are told from damage by what follows:
/// - a stamp that falls from near 2^31 to near zero, or overflows to negative, wrapped;
/// - a leap of more than kLongestStep is believed when the next record does not lie before it, else
///   that one record is damage (a flipped bit would otherwise put all that follows in the past);
/// - a step back is jitter or damage, and the user's business, until kResetRecords records in a row
///   go on from there: then the clock was reset or files were joined, and time goes on from where
///   it was, with the first of them.
class AedatTimeline {
public:
    static constexpr std::int64_t kLongestStep = 100'000;  // us; no more is lost to one bad time
    static constexpr std::int64_t kLongestSilence = 60'000'000;  // us, after a reset
    static constexpr std::int64_t kJitter = 10'000;              // us, no reset is as small
    static constexpr std::size_t kResetRecords = 32;

    /// Calls take(record, t) with the time in us for this record, and those held back before it;
    /// reset(t) before a record after a reset. t may lie before an earlier one.
    template <typename Take, typename Reset>
    void push(const AedatRecord& record, Damage& damage, Take&& take, Reset&& reset) {
        if (std::exchange(joined_, false) && started_ && record.stamp < last_stamp_)
            begin_anew(record.stamp, reset);
        if ((held_ || step_to(record.stamp) > kLongestStep) && !settle(record, damage, take))
            return;
        if (started_ && step_to(record.stamp) < -kJitter)
            keep(record, take, reset);
        else
            place(record, take);
    }

    /// The next record is of another file, whose clock may have been reset: then time goes on from
    /// where it was.
    template <typename Take>
    void join(Take&& take) {
        finish(take);
        joined_ = true;
    }

    /// The stream ended: nothing can contradict the record held back, nor confirm a reset.
    template <typename Take>
    void finish(Take&& take) {
        if (held_) place(*held_, take);
        held_.reset();
        let_past_go(take);
    }

    void resync() { *this = {}; }

    std::optional<std::int64_t> newest() const {
        return started_ ? std::optional(last_) : std::nullopt;
    }

private:
    /// us from one stamp to the next.
    static std::int64_t step_between(std::int32_t from, std::int32_t to) {
        const auto step = std::int64_t(std::int32_t(std::uint32_t(to) - std::uint32_t(from)));
        const bool wrapped_31_bits = step < -(std::int64_t(1) << 30) && to >= 0 && from >= 0;
        return wrapped_31_bits ? step + (std::int64_t(1) << 31) : step;
    }

    /// us from the newest time to this stamp.
    std::int64_t step_to(std::int32_t stamp) const {
        return started_ ? step_between(last_stamp_, stamp) : 0;
    }

    /// Takes or drops the record held back; false when this one is now held back.
    template <typename Take>
    bool settle(const AedatRecord& record, Damage& damage, Take& take) {
        if (held_) {
            if (step_between(held_->stamp, record.stamp) >= 0)
                place(*held_, take);
            else
                damage.count(DamageReason::bad_record);
            held_.reset();
        }
        if (step_to(record.stamp) <= kLongestStep) return true;
        held_ = record;
        return false;
    }

    template <typename Reset>
    void begin_anew(std::int32_t stamp, Reset& reset) {
        last_stamp_ = stamp;
        reset(last_);
    }

    /// A record far in the past, until it is known whether the clock was reset.
    template <typename Take, typename Reset>
    void keep(const AedatRecord& record, Take& take, Reset& reset) {
        const auto goes_on_from = [&](std::int64_t stamp) {
            return record.stamp >= stamp - kJitter && record.stamp - stamp <= kLongestSilence;
        };
        if (!past_.empty() && !goes_on_from(past_.back().stamp)) let_past_go(take);
        past_.push_back(record);
        if (past_.size() <= kResetRecords) return;
        begin_anew(past_.front().stamp, reset);
        for (const AedatRecord& kept : std::exchange(past_, {})) place(kept, take);
    }

    /// There was no reset.
    template <typename Take>
    void let_past_go(Take& take) {
        for (const AedatRecord& kept : past_) take(kept, last_ + step_to(kept.stamp));
        past_.clear();
    }

    template <typename Take>
    void place(const AedatRecord& record, Take& take) {
        if (!started_) {
            started_ = true;
            last_ = last_stamp_ = record.stamp;
        }
        const std::int64_t step = step_to(record.stamp);
        if (step >= 0) let_past_go(take);
        take(record, last_ + step);
        if (step < 0) return;
        last_ += step;
        last_stamp_ = record.stamp;
    }

    bool started_ = false;
    std::int64_t last_ = 0;        ///< us, the newest
    std::int32_t last_stamp_ = 0;  ///< as it stood in the record
    std::optional<AedatRecord> held_;
    std::vector<AedatRecord> past_;  ///< at most kResetRecords, in a row
    bool joined_ = false;            ///< since the record before
};

}  // namespace eventide
