// What each pixel's newest event was, in four bytes.
#pragma once

#include "src/core/event.h"

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

    /// Before the others are asked about an event: time has come to `now`, which may lie before
    /// that of the last call by up to a second.
    void advance(SensorTime now) noexcept {
        if (now - swept_ >= kSweep) sweep(now);
    }

    void set(const Event& event) noexcept { words_[at(event)] = word(event); }

    /// Of the eight pixels around an event's.
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

}  // namespace eventide
