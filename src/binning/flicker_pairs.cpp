// Pairs of on and off, half a period apart.
#include "src/binning/flicker_pairs.h"

#include "src/core/duration_text.h"
#include "src/core/error.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace eventide {
namespace {

/// Whether so much time is about a half, one and a half, ... periods.
bool is_between(double us, double period_us) {
    constexpr double kQuarter = .25;
    const double periods = us / period_us;
    return std::abs(periods - std::floor(periods) - .5) <= kQuarter;
}

}  // namespace

FlickerPairs::FlickerPairs(int width, int height, SensorDuration longest, std::uint32_t renumber_at)
    : width_(width), longest_(longest), renumber_at_(renumber_at), period_(width, height) {
    newest_.resize(std::size_t(width) * std::size_t(height));
}

SensorDuration FlickerPairs::delay() const {
    constexpr double kOfAPeriod = .75;
    if (period_.us() == 0) return SensorDuration{0};
    if (longest_.count() > 0) return longest_;
    return SensorDuration{std::int64_t(kOfAPeriod * period_.us())};
}

/// Of two of a pixel, the first of which is still held and so no older than delay().
bool FlickerPairs::is_pair(const Event& a, const Event& b) const {
    return a.polarity != b.polarity && is_between(double((b.t - a.t).count()), period_.us());
}

void FlickerPairs::process(std::vector<Event>& events) {
    std::size_t i = 0;
    for (; i < events.size() && period_.us() == 0; ++i) period_.see(events[i]);
    if (i == events.size()) return;  // nothing flickers, and nothing is held
    out_.assign(events.begin(), events.begin() + std::ptrdiff_t(i));
    for (; i < events.size(); ++i) {
        const Event& event = events[i];
        if (event.t < now_) flush(out_);
        now_ = event.t;
        // The event that tells the period is not held itself.
        const bool was_known = period_.us() != 0;
        period_.see(event);
        if (!was_known || period_.us() == 0) {
            flush(out_);
            out_.push_back(event);
        } else {
            last_period_us_ = period_.us();
            release(now_, out_);
            if (held_count_ >= kMostHeld) let_go(out_);
            hold(event);
        }
    }
    std::swap(events, out_);
}

void FlickerPairs::hold(const Event& event) {
    std::uint32_t& newest = newest_of(event);
    if (newest >= first_) {
        Held& last = held_[gone_ + (newest - first_)];
        if (is_pair(last.event, event)) {
            last.left_out = true;
            newest = last.before;
            --held_count_;
            left_out_ += 2;
            return;
        }
    }
    keep(event);
}

void FlickerPairs::keep(const Event& event) {
    std::uint32_t& newest = newest_of(event);
    held_.push_back({event, newest, false});
    newest = first_ + std::uint32_t(held_.size() - gone_) - 1;
    ++held_count_;
}

/// The oldest comes out, where it is not left out.
void FlickerPairs::let_go(std::vector<Event>& events) {
    const Held& oldest = held_[gone_++];
    ++first_;
    if (oldest.left_out) return;
    events.push_back(oldest.event);
    --held_count_;
}

void FlickerPairs::release(SensorTime now, std::vector<Event>& events) {
    const SensorTime until = known_until(now);
    while (gone_ < held_.size() && (held_[gone_].left_out || held_[gone_].event.t < until))
        let_go(events);
    if (2 * gone_ < held_.size()) return;
    held_.erase(held_.begin(), held_.begin() + std::ptrdiff_t(gone_));
    gone_ = 0;
    if (first_ >= renumber_at_) renumber();
}

/// Before numbers run out: what is held is counted from 1 again. Nothing of held_ is gone.
void FlickerPairs::renumber() noexcept {
    const auto renumbered = [this](std::uint32_t& number) {
        number = number >= first_ ? number - first_ + 1 : 0;
    };
    std::ranges::for_each(newest_, renumbered);
    for (Held& held : held_) renumbered(held.before);
    first_ = 1;
}

void FlickerPairs::flush(std::vector<Event>& events) {
    while (gone_ < held_.size()) let_go(events);
    held_.clear();
    gone_ = 0;
}

void FlickerPairs::reset() noexcept {
    period_.reset();
    forget_held();
}

void FlickerPairs::forget_held() noexcept {
    std::ranges::fill(newest_, 0U);
    held_.clear();
    gone_ = held_count_ = 0;
    first_ = 1;
    now_ = SensorTime::min();
}

FlickerPairs::State FlickerPairs::state() const {
    State state{period_.state(), {}};
    for (const Held& held : std::span{held_}.subspan(gone_))
        if (!held.left_out) state.held.push_back(held.event);
    return state;
}

void FlickerPairs::restore(const State& state) {
    if (state.period.period_us == 0 && !state.held.empty())
        throw Error(ErrorKind::input, "flicker: expected no events held back, as nothing flickers");
    period_.restore(state.period);
    forget_held();
    for (const Event& event : state.held) {
        keep(event);
        now_ = event.t;
    }
}

std::optional<SensorDuration> parse_lamp_flicker(std::string_view text, bool can_wait) {
    constexpr SensorDuration kWaits{16'000};
    if (text == "off") return std::nullopt;
    if (text == "auto") return can_wait ? kWaits : SensorDuration{0};
    const auto longest = read_duration(text);
    if (!longest || longest->count() < 1 || *longest > FlickerPairs::kLongest)
        throw Error(
            ErrorKind::usage,
            "lamp flicker: expected auto, off or a time up to 100 ms such as 10ms, found '" +
                std::string(text) + "'");
    return longest;
}

}  // namespace eventide
