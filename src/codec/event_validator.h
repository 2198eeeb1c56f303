// The rules every event passes: inside the sensor, not before the one before it, no lone leap.
#pragma once

#include "src/core/damage.h"
#include "src/core/event.h"
#include "src/core/sensor_limits.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace eventide {

/// Takes events in the order of the stream. A leap of more than kLongestStep is believed when what
/// follows does not lie before it; else it counts as bad_record: one flipped bit would otherwise
/// put all that follows in the past. What follows is the next event or, where events come in
/// packets that are damaged as a whole, the next packet: until then all after the leap is held.
///
/// The stream's first event is held until another agrees with it. Where the next ones agree only
/// with each other, before it or more than kLongestFirstPause after it, it counts as bad_record: a
/// stamp of 0 before times since 1970 would otherwise be 54 years of silence.
///
/// A time further from zero than kFarthest counts as bad_record wherever it stands: sums of such
/// times are beyond 64 bits, and windows until then without end.
class EventValidator {
public:
    enum class LeapEnds { with_next_event, with_next_packet };
    static constexpr std::int64_t kLongestStep = 100'000;  // us; no more is lost to one bad time
    static constexpr std::int64_t kLongestFirstPause = 60'000'000;  // us
    static constexpr std::int64_t kFarthest = kFarthestUs;

    /// For a sensor of `width` x `height` px.
    EventValidator(std::uint64_t width, std::uint64_t height,
                   LeapEnds leap_ends = LeapEnds::with_next_event)
        : width_(width), height_(height), leap_ends_(leap_ends) {}

    void add(std::int64_t t_us, std::uint64_t x, std::uint64_t y, bool on, Batch& into,
             Damage& damage) {
        if (!is_inside(x, y)) {
            damage.count(DamageReason::out_of_range);
            return;
        }
        if (t_us > kFarthest || t_us < -kFarthest) {
            damage.count(DamageReason::bad_record);
            return;
        }
        const Event event{from_us(t_us), std::uint16_t(x), std::uint16_t(y), Polarity(on)};
        if (!newest_) {
            begin_with(event);
        } else if (!held_.empty() || is_leap(t_us)) {
            add_after_leap(event, into, damage);
        } else if (t_us < *newest_) {
            step_back(event, damage);
        } else {
            take_first(into);
            newest_ = t_us;
            into.events.push_back(event);
        }
    }

    /// For LeapEnds::with_next_packet: the events that come next are in another packet.
    void end_packet() { in_packet_of_leap_ = false; }

    /// The stream ended: nothing can contradict the events held back.
    void finish(Batch& into, Damage& damage) {
        if (held_.size() > 1) judge_first(into, damage);
        take_first(into);
        take_held(into);
    }

    /// Takes up anywhere in time. What is still held is lost: nothing that could follow it will.
    void resync(Damage& damage) {
        damage.count(DamageReason::truncated, held_.size() + (first_ ? 1 : 0));
        held_.clear();
        first_.reset();
        newest_.reset();
    }

    bool is_inside(std::uint64_t x, std::uint64_t y) const { return x < width_ && y < height_; }
    std::uint64_t width() const { return width_; }
    std::uint64_t height() const { return height_; }
    std::optional<std::int64_t> newest_us() const { return newest_; }  ///< of the events taken

    /// For callers that take many events in a loop of their own: whether one at this time, inside
    /// the sensor, may be taken without add().
    bool is_plain(std::int64_t t_us) const {
        return newest_ && held_.empty() && !first_ && t_us >= *newest_ &&
               t_us - *newest_ <= kLongestStep;
    }
    void pass(std::int64_t t_us) { newest_ = t_us; }  ///< the newest so taken

private:
    /// us from one time to a later one; times as far apart as 64 bits allow.
    static std::uint64_t between(std::int64_t earlier, std::int64_t later) {
        return std::uint64_t(later) - std::uint64_t(earlier);
    }

    bool is_leap(std::int64_t t_us) const {
        return t_us > *newest_ && between(*newest_, t_us) > std::uint64_t(kLongestStep);
    }

    void step_back(const Event& event, Damage& damage) {
        if (!first_ || between(to_us(event.t), *newest_) <= std::uint64_t(kLongestStep))
            return damage.count(DamageReason::time_backwards);
        damage.count(DamageReason::bad_record);  // the first one lied
        first_.reset();
        begin_with(event);
    }

    void begin_with(const Event& event) {
        first_ = event;
        newest_ = to_us(event.t);
    }

    void take_first(Batch& into) {
        if (first_) into.events.push_back(*first_);
        first_.reset();
    }

    /// The events after a leap agree with each other: does the first one, too?
    void judge_first(Batch& into, Damage& damage) {
        if (first_ &&
            between(to_us(first_->t), to_us(held_.front().t)) > std::uint64_t(kLongestFirstPause)) {
            damage.count(DamageReason::bad_record);
            first_.reset();
        }
        take_first(into);
    }

    void take_held(Batch& into) {
        if (held_.empty()) return;
        newest_ = to_us(held_.back().t);
        into.events.insert(into.events.end(), held_.begin(), held_.end());
        held_.clear();
    }

    void add_after_leap(const Event& event, Batch& into, Damage& damage) {
        if (held_.empty()) {
            held_.push_back(event);
            in_packet_of_leap_ = leap_ends_ == LeapEnds::with_next_packet;
            return;
        }
        if (event.t < held_.front().t) {
            damage.count(DamageReason::bad_record, held_.size());
            held_.clear();
        } else if (in_packet_of_leap_) {
            if (event.t < held_.back().t)
                damage.count(DamageReason::time_backwards);
            else
                held_.push_back(event);
            return;
        } else {
            judge_first(into, damage);
            take_held(into);
        }
        add(to_us(event.t), event.x, event.y, event.polarity == Polarity::on, into, damage);
    }

    std::uint64_t width_, height_;
    std::optional<std::int64_t> newest_;  ///< us
    std::optional<Event> first_;          ///< of the stream, until another agrees with it
    std::vector<Event> held_;             ///< after a leap, until it is believed or not
    LeapEnds leap_ends_;
    bool in_packet_of_leap_ = false;
};

}  // namespace eventide
