// What EVT2, EVT2.1 and EVT3 share: high times, events in blocks.
#pragma once

#include "src/codec/whole_words.h"
#include "src/core/damage.h"
#include "src/core/event.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace eventide {

/// The upper bits of the time, which come in words of their own and wrap.
///
/// A fall by at least half the range is a wrap, a smaller one noise. A leap forward beyond
/// `longest_leap_us`, which cameras never make (they send these words all the time), is doubted
/// until the next such word: if that lies at or after it, time goes on from there.
class EvtTimeHigh {
public:
    EvtTimeHigh(int bits, int shift, std::int64_t longest_leap_us)
        : range_(std::int64_t(1) << bits), shift_(shift), longest_(longest_leap_us >> shift) {}

    void push(std::int64_t value, Damage& damage) {
        if (!heard_) {
            last_ = ever_heard_ ? unwrapped(value) : value;
            heard_ = ever_heard_ = true;
            return;
        }
        const std::int64_t at = unwrapped(value);
        const bool leap = at - last_ > longest_;
        if (in_doubt_ && at >= doubtful_) {
            last_ = doubtful_;
            in_doubt_ = at - last_ > longest_;
            doubtful_ = at;
            if (!in_doubt_) last_ = at;
            return;
        }
        if (in_doubt_) damage.count(DamageReason::bad_record);
        in_doubt_ = leap;
        doubtful_ = at;
        if (!leap) last_ = at;
    }

    bool is_known() const { return heard_; }
    bool is_sure() const { return heard_ && !in_doubt_; }
    std::int64_t us() const { return last_ * (std::int64_t(1) << shift_); }

    /// Words were lost: the time is not known before the next word; that may be any later one.
    void gap() { heard_ = in_doubt_ = false; }

private:
    std::int64_t unwrapped(std::int64_t value) const {
        const std::int64_t in_range = last_ & (range_ - 1);
        const std::int64_t step = value - in_range;
        return last_ + step + (step <= -range_ / 2 ? range_ : 0);
    }

    std::int64_t range_;
    int shift_;
    std::int64_t longest_;   ///< leap, in units of this word
    std::int64_t last_ = 0;  ///< with wraps
    std::int64_t doubtful_ = 0;
    bool heard_ = false, ever_heard_ = false, in_doubt_ = false;
};

/// A block of events on its way into a batch: written without checks for room, passed on when full.
class EventBlock {
public:
    static constexpr std::size_t kSize = 1024;
    static constexpr std::size_t kMaxAtOnce = 32;  ///< events written between two calls of full()

    EventBlock() : events_(kSize + kMaxAtOnce) {}
    Event* data() { return events_.data(); }
    static bool full(std::size_t n) { return n >= kSize; }

    /// Passes the first n events on.
    void pass(std::size_t n, Batch& into) {
        into.events.insert(into.events.end(), events_.begin(), events_.begin() + std::ptrdiff_t(n));
    }

private:
    std::vector<Event> events_;
};

constexpr std::int64_t kNoTime = std::numeric_limits<std::int64_t>::min();

}  // namespace eventide
