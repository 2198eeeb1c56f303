// What EVT2, EVT2.1 and EVT3 share: high times, events in blocks.
#pragma once

#include "src/codec/event_validator.h"
#include "src/codec/whole_words.h"
#include "src/core/damage.h"
#include "src/core/event.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace eventide {

/// The upper bits of the time, which come in words of their own and wrap, and the data of times
/// that are in doubt.
///
/// A fall by at least half the range is a wrap, a smaller one noise. The first such word, and one
/// that leaps by more than EventValidator::kLongestStep, is doubted until the next: data of that
/// time wait, come out where the next word does not contradict it, and count as bad_record where
/// it does. Cameras repeat these words all the time; after a real silence one follows soon.
///
/// A camera that was opened again may count from anywhere, and its few bits do not tell how long it
/// was away: its first word, once the next agrees, is taken to mean what the host's clock says.
/// Neither do they tell how long a loss was: of the times a first word behind one may mean, the one
/// that is nearest to the host's clock is taken, and none before the loss.
class EvtTimeHigh {
public:
    static constexpr std::size_t kMaxHeld = std::size_t{1} << 20;  // of more the time is believed

    EvtTimeHigh(int bits, int shift)
        : range_(std::int64_t(1) << bits),
          shift_(shift),
          longest_(EventValidator::kLongestStep >> shift) {}

    /// The next words arrived at this time of the host's clock.
    void arrives(HostTime at) { arrived_ = at; }

    void push(std::int64_t told, Batch& into, Damage& damage) {
        const std::int64_t value = (told + turn_) & (range_ - 1);
        if (!heard_)
            begin(value);
        else if (leap_)
            judge_leap(value, into, damage);
        else if (first_)
            judge_first(value, into, damage);
        else
            go_on_to(unwrapped(value));
    }

    /// With the next call of a parser, before its words: what was believed at a gap.
    void hand_out(Batch& into) { append(before_gap_, into); }

    bool is_known() const { return heard_; }
    bool is_sure() const { return heard_ && !first_ && !leap_; }
    std::int64_t us() const { return high() * (std::int64_t(1) << shift_); }

    /// Where the time is known and not sure.
    void hold(const Event& event, Batch& into, Damage& damage) {
        waiting().events.push_back(event);
        believe_what_is_too_much(into, damage);
    }
    void hold(const Trigger& trigger, Batch& into, Damage& damage) {
        waiting().triggers.push_back(trigger);
        believe_what_is_too_much(into, damage);
    }
    bool holds_later(SensorTime t) const {
        const auto is_later = [t](const std::optional<Doubt>& doubt) {
            return doubt && !doubt->data.events.empty() && t < doubt->data.events.back().t;
        };
        return is_later(leap_) || (!leap_ && is_later(first_));
    }

    /// Nothing comes that could contradict a first time.
    void believe_first(Batch& into) {
        if (!first_ || leap_) return;
        tell(first_->high);
        let_go(first_, into);
    }
    /// Nor any other.
    void believe(Batch& into, Damage& damage) {
        hand_out(into);
        if (first_ && leap_ && leap_->high < first_->high) drop(first_, damage);
        tell(high());
        let_go(first_, into);
        let_go(leap_, into);
    }

    /// Words were lost: the time is not known before the next word; that may be any later one.
    void gap(Damage& damage) {
        if (leap_) drop(leap_, damage);
        believe_first(before_gap_);
        heard_ = false;
    }
    /// After gap(): the camera was opened again.
    void go_on_by_host() { anew_ = true; }

private:
    struct Doubt {
        std::int64_t high = 0;
        Batch data{};
    };

    std::int64_t high() const { return leap_ ? leap_->high : first_ ? first_->high : last_; }
    Batch& waiting() { return leap_ ? leap_->data : first_->data; }

    std::int64_t unwrapped(std::int64_t value) const {
        const std::int64_t in_range = last_ & (range_ - 1);
        const std::int64_t step = value - in_range;
        return last_ + step + (step <= -range_ / 2 ? range_ : 0);
    }
    /// From a time with wraps to the nearest with this value.
    std::int64_t step_from(std::int64_t high, std::int64_t value) const {
        return ((value - high + range_ / 2) & (range_ - 1)) - range_ / 2;
    }
    void tell(std::int64_t high) {
        last_ = high;
        told_at_ = arrived_;
    }
    bool is_near(std::int64_t step) const { return step >= -longest_ && step <= longest_; }
    /// Since the last time that was believed, by the host's clock.
    std::optional<std::int64_t> passed() const {
        if (!arrived_ || !told_at_) return std::nullopt;
        const auto us = std::chrono::duration_cast<SensorDuration>(*arrived_ - *told_at_).count();
        return std::max<std::int64_t>(us, 0) >> shift_;
    }
    /// Since the beginning or a loss.
    std::int64_t first_time(std::int64_t value) const {
        if (!ever_heard_) return value;
        const auto passed = this->passed();
        if (!passed) return unwrapped(value);
        const std::int64_t by_host = last_ + *passed;
        const std::int64_t nearest = by_host + step_from(by_host, value);
        return nearest < last_ - longest_ ? nearest + range_ : nearest;
    }

    void begin(std::int64_t value) {
        first_ = Doubt{anew_ ? time_by_host(value) : first_time(value)};
        heard_ = true;
    }

    /// What the word means where the camera counts from elsewhere: later than all before, and as
    /// much as the host's clock says.
    std::int64_t time_by_host(std::int64_t value) {
        const auto passed = this->passed();
        if (!ever_heard_ || !passed) return first_time(value);
        const std::int64_t high = last_ + 1 + *passed;
        turn_ += high - value;
        return high;
    }

    void judge_first(std::int64_t value, Batch& into, Damage& damage) {
        const std::int64_t step = step_from(first_->high, value);
        if (!is_near(step) && anew_) {  // neither is known to be right: this one is the newer
            drop(first_, damage);
            return begin(value);
        }
        if (!is_near(step)) {
            // Where the host's clock is known the first word has no say in what this one means.
            leap_ = Doubt{step > 0 && !passed() ? first_->high + step : first_time(value)};
            return;
        }
        tell(first_->high + step);
        let_go(first_, into);
    }

    /// One of two times that disagree is wrong where the next word is near the other.
    void judge_leap(std::int64_t value, Batch& into, Damage& damage) {
        const std::int64_t step = step_from(leap_->high, value);
        const std::int64_t before = first_ ? first_->high : last_;
        const bool is_back = is_near(step_from(before, value)) || leap_->high < before;
        if (!is_near(step) && (step < 0 || is_back)) {
            drop(leap_, damage);
            return push(value - turn_, into, damage);
        }
        if (first_ && !may_precede(first_->high, leap_->high)) drop(first_, damage);
        tell(leap_->high);
        let_go(first_, into);
        let_go(leap_, into);
        go_on_to(last_ + step);
    }

    void go_on_to(std::int64_t at) {
        if (is_near(at - last_))
            tell(at);
        else
            leap_ = Doubt{at};
    }

    bool may_precede(std::int64_t first, std::int64_t next) const {
        return next >= first && next - first <= EventValidator::kLongestFirstPause >> shift_;
    }

    void let_go(std::optional<Doubt>& doubt, Batch& into) {
        ever_heard_ = true;
        anew_ = false;
        if (doubt) append(doubt->data, into);
        doubt.reset();
    }
    static void drop(std::optional<Doubt>& doubt, Damage& damage) {
        const Batch& data = doubt->data;
        damage.count(DamageReason::bad_record, 1 + data.events.size() + data.triggers.size());
        doubt.reset();
    }
    static void append(Batch& data, Batch& into) {
        into.events.insert(into.events.end(), data.events.begin(), data.events.end());
        into.triggers.insert(into.triggers.end(), data.triggers.begin(), data.triggers.end());
        data.clear();
    }
    void believe_what_is_too_much(Batch& into, Damage& damage) {
        if (waiting().events.size() + waiting().triggers.size() >= kMaxHeld) believe(into, damage);
    }

    std::int64_t range_;
    int shift_;
    std::int64_t longest_;        ///< step, in units of this word
    std::int64_t last_ = 0;       ///< believed, with wraps
    std::optional<Doubt> first_;  ///< since the beginning or a gap
    std::optional<Doubt> leap_;
    Batch before_gap_;  ///< comes out with the next call
    bool heard_ = false, ever_heard_ = false;
    std::int64_t turn_ = 0;                      ///< added to what words tell
    bool anew_ = false;                          ///< until a first word is believed
    std::optional<HostTime> arrived_, told_at_;  ///< of these words; of those that told last_
};

constexpr std::int64_t kNoTime = std::numeric_limits<std::int64_t>::min();

/// Where a file was joined to another: says that time began anew, if it did.
class FileSeam {
public:
    void begin_file(std::int64_t last_us) { last_us_ = std::max(last_us_, last_us); }
    /// A time of the file behind it, each until one is believed: the first may lie.
    void see(std::int64_t t_us, Batch& into) {
        if (t_us >= last_us_) return;
        into.triggers.push_back({from_us(t_us), Trigger::Kind::timestamp_reset, 0});
        end();
    }
    void end() { last_us_ = kNoTime; }  ///< its data came out

private:
    std::int64_t last_us_ = kNoTime;  ///< of what came out before
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

}  // namespace eventide
