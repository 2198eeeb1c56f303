// What each pixel's newest event was.
#include "src/binning/newest_events.h"

#include "src/core/simd4.h"

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

NewestEvents::Around NewestEvents::around(const Event& event, SensorDuration fired_within,
                                          SensorDuration alike_within) const noexcept {
    using namespace lanes;
    // now - word is twice the age, and 1 more where that event was off; less half of the numbers'
    // range, so that what lies ahead is the largest of signed numbers.
    constexpr std::uint32_t kHalf = std::uint32_t{1} << 31;
    const U4 now = splat(word(event) | 1) + kHalf;
    const auto limit = [](SensorDuration within) {
        return I4(splat(std::uint32_t(2 * within.count() + 1) - kHalf));
    };
    const I4 fired_limit = limit(fired_within), alike_limit = limit(alike_within);
    const I4 off = I4(splat(event.polarity == Polarity::off ? 1U : 0U));
    constexpr std::int32_t kNever = 0x7FFF'FFFF;
    I4 found{};  // fired + 256 alike, of each column; the fourth is none of the neighbours'
    const auto look_at = [&](std::size_t first, I4 not_these) {
        const I4 ages = I4(now - load(&words_[first])) | not_these;
        const I4 like = ((ages ^ off) & 1) == 0;
        found -= (ages <= fired_limit) + 256 * (like & (ages <= alike_limit));
    };
    const std::size_t own = at(event);
    look_at(own - stride_ - 1, I4{});
    look_at(own - 1, I4{0, kNever, 0, 0});
    look_at(own + stride_ - 1, I4{});
    const std::int32_t sum = found[0] + found[1] + found[2];
    return {sum & 0xFF, sum >> 8};
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
