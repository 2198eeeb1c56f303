// What each pixel's newest event was.
#include "src/binning/newest_events.h"

#include <algorithm>

namespace eventide {

NewestEvents::NewestEvents(int width, int height)
    : stride_(std::size_t(width) + 2), rows_(std::size_t(height) + 2), words_(size() + 1) {
    forget(SensorTime{});
}

void NewestEvents::forget(SensorTime now) noexcept {
    std::ranges::fill(words_, old_at(now));
    swept_ = now;
}

// How long before `now`; below 0: after it.
SensorDuration NewestEvents::age(std::uint32_t word, SensorTime now) const {
    constexpr std::uint32_t kRound = std::uint32_t{1} << 31, kAhead = std::uint32_t{1} << 25;
    const std::uint32_t us = (std::uint32_t(to_us(now)) - (word >> 1)) & (kRound - 1);
    return SensorDuration{us < kRound - kAhead ? std::int64_t(us) : std::int64_t(us) - kRound};
}

void NewestEvents::sweep(SensorTime now) noexcept {
    // Since the last sweep all were at most kSweep + kLongest old: after twice that, all are old.
    const bool all = now - swept_ >= kSweep + kSweep / 2;
    for (std::uint32_t& word : words_)
        if (all || age(word, now) > kLongest) word = old_at(now);
    swept_ = now;
}

std::vector<SensorTime> NewestEvents::times(SensorTime now) const {
    std::vector<SensorTime> times;
    for (std::size_t i = 0; i < size(); ++i) {
        const SensorDuration ago = age(words_[i], now);
        times.push_back(ago > kLongest ? SensorTime::min() : now - ago);
    }
    return times;
}

std::vector<Polarity> NewestEvents::polarities(SensorTime now) const {
    std::vector<Polarity> polarities;
    for (std::size_t i = 0; i < size(); ++i) {
        const bool on = age(words_[i], now) <= kLongest && (words_[i] & 1) != 0;
        polarities.push_back(on ? Polarity::on : Polarity::off);
    }
    return polarities;
}

void NewestEvents::restore(SensorTime now, const std::vector<SensorTime>& times,
                           const std::vector<Polarity>& polarities) noexcept {
    constexpr SensorDuration kAhead{1'000'000};
    forget(now);
    for (std::size_t i = 0; i < size(); ++i)
        if (times[i] >= now - kLongest && times[i] <= now + kAhead)
            words_[i] = word({times[i], 0, 0, polarities[i]});
}

}  // namespace eventide
