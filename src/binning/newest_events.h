// What each pixel's newest event was, in four bytes.
#pragma once

#include "src/core/event.h"
#include "src/core/simd4.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace eventide {

/// Time and polarity of each pixel's newest event, as far as it is no older than kLongest. A rim of
/// one pixel around the sensor never fires. One thread.
class NewestEvents {
public:
    static constexpr SensorDuration kLongest{10'000'000};

    NewestEvents(int width, int height);

    /// No pixel has had an event yet; time goes on from `now`.
    void forget(SensorTime now) noexcept;

    /// Time has come to `now`: call it before anything is asked about an event. `now` may lie
    /// before that of the last call by up to a second.
    void advance(SensorTime now) noexcept {
        if (now - swept_ >= kSweep) sweep(now);
    }

    void set(const Event& event) noexcept { words_[at(event)] = word(event); }

    /// How many of the eight pixels around an event's fired.
    struct Around {
        int fired = 0;  ///< within `fired_within` before it
        int alike = 0;  ///< with its polarity, within `alike_within` before it
    };
    /// Times from 0 to kLongest. What is later than the event counts as not fired.
    Around around(const Event& event, SensorDuration fired_within,
                  SensorDuration alike_within) const noexcept;

    /// [y + 1][x + 1], rim included, as known at `now`: SensorTime::min() and off where there was
    /// no event, or only an older one.
    std::vector<SensorTime> times(SensorTime now) const;
    std::vector<Polarity> polarities(SensorTime now) const;
    /// As they were given by another one of the same size, in which time had come to `now`.
    void restore(SensorTime now, const std::vector<SensorTime>& times,
                 const std::vector<Polarity>& polarities) noexcept;
    std::size_t size() const { return stride_ * rows_; }  ///< rim included

    /// Asks the processor for what around() and set() of a later event will read.
    void prefetch(const Event& event) const noexcept {
        const std::uint32_t* own = &words_[at(event)];
        __builtin_prefetch(own - stride_);
        __builtin_prefetch(own);
        __builtin_prefetch(own + stride_);
    }

private:
    /// Microseconds are kept modulo 2^31; well before they come round, old ones are made older.
    static constexpr SensorDuration kSweep{std::int64_t{1} << 30};

    static std::uint32_t word(const Event& event) {
        return std::uint32_t(to_us(event.t)) << 1 | (event.polarity == Polarity::on ? 1U : 0U);
    }
    static std::uint32_t old_at(SensorTime now) {
        return word({now - kLongest - SensorDuration{1}, 0, 0, Polarity::off});
    }
    std::size_t at(const Event& event) const {
        return (std::size_t(event.y) + 1) * stride_ + event.x + 1;
    }
    SensorDuration age(std::uint32_t word, SensorTime now) const;
    void sweep(SensorTime now) noexcept;

    std::size_t stride_, rows_;
    std::vector<std::uint32_t> words_;  // [y + 1][x + 1]: us << 1 | on; one beyond the end is read
    SensorTime swept_{};
};

inline NewestEvents::Around NewestEvents::around(const Event& event, SensorDuration fired_within,
                                                 SensorDuration alike_within) const noexcept {
    using namespace lanes;
    // now - word is twice the age, and 1 more where that event was off; less half of the numbers'
    // range, so that what lies ahead is the largest of signed numbers.
    constexpr std::uint32_t kHalf = std::uint32_t{1} << 31;
    const U4 now = splat(word(event) | 1) + kHalf;
    const auto above = [](SensorDuration within) {
        return I4(splat(std::uint32_t(2 * within.count() + 2) - kHalf));
    };
    const I4 above_fired = above(fired_within), above_alike = above(alike_within);
    const I4 on = I4(splat(event.polarity == Polarity::on ? 1U : 0U));
    constexpr std::int32_t kNever = 0x7FFF'FFFF;
    I4 fired{}, alike{};  // of each column; the fourth is none of the neighbours'
    const auto look_at = [&](std::size_t first, I4 not_these) {
        const I4 ages = I4(now - load(&words_[first])) | not_these;
        fired -= ages < above_fired;
        alike += (ages ^ on) & (ages < above_alike) & 1;
    };
    const std::size_t own = at(event);
    look_at(own - stride_ - 1, I4{});
    look_at(own - 1, I4{0, kNever, 0, 0});
    look_at(own + stride_ - 1, I4{});
    const I4 found = fired + 256 * alike;
    const std::int32_t sum = found[0] + found[1] + found[2];
    return {sum & 0xFF, sum >> 8};
}

}  // namespace eventide
