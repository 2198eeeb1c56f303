// The rules every event passes: inside the sensor, not before the one before it, no lone leap.
#pragma once

#include "src/core/damage.h"
#include "src/core/event.h"

#include <cstdint>
#include <optional>

namespace eventide {

/// Takes events in the order of the stream. A leap of more than kLongestStep is believed when the
/// next event does not lie before it; else it counts as bad_record: one flipped bit would otherwise
/// put all that follows in the past.
class EventLine {
public:
    static constexpr std::int64_t kLongestStep = 100'000;  // us; no more is lost to one bad time

    /// px
    EventLine(std::uint64_t width, std::uint64_t height) : width_(width), height_(height) {}

    void add(std::int64_t t_us, std::uint64_t x, std::uint64_t y, bool on, Batch& into,
             Damage& damage) {
        if (x >= width_ || y >= height_) {
            damage.count(DamageReason::out_of_range);
            return;
        }
        const Event event{from_us(t_us), std::uint16_t(x), std::uint16_t(y), Polarity(on)};
        if (held_ || is_leap(t_us)) {
            add_after_leap(event, into, damage);
        } else if (newest_ && t_us < *newest_) {
            damage.count(DamageReason::time_backwards);
        } else {
            newest_ = t_us;
            into.events.push_back(event);
        }
    }

    /// The stream ended: nothing can contradict the event held back.
    void finish(Batch& into) {
        if (held_) take_held(into);
    }

    /// Takes up anywhere in time.
    void resync() {
        held_.reset();
        newest_.reset();
    }

    std::uint64_t width() const { return width_; }
    std::uint64_t height() const { return height_; }
    std::optional<std::int64_t> newest_us() const { return newest_; }  ///< of the events taken

    /// For a loop of its own over many events: true when this time needs no more than a look.
    bool is_plain(std::int64_t t_us) const {
        return newest_ && !held_ && t_us >= *newest_ && t_us - *newest_ <= kLongestStep;
    }
    void pass(std::int64_t t_us) { newest_ = t_us; }  ///< after is_plain()

private:
    bool is_leap(std::int64_t t_us) const {
        return newest_ && t_us > *newest_ &&
               std::uint64_t(t_us) - std::uint64_t(*newest_) > std::uint64_t(kLongestStep);
    }

    void take_held(Batch& into) {
        newest_ = to_us(held_->t);
        into.events.push_back(*held_);
        held_.reset();
    }

    void add_after_leap(const Event& event, Batch& into, Damage& damage) {
        if (!held_) {
            held_ = event;
            return;
        }
        if (event.t >= held_->t)
            take_held(into);
        else
            damage.count(DamageReason::bad_record);
        held_.reset();
        add(to_us(event.t), event.x, event.y, event.polarity == Polarity::on, into, damage);
    }

    std::uint64_t width_, height_;
    std::optional<std::int64_t> newest_;  ///< us
    std::optional<Event> held_;           ///< after a leap, until the next event
};

}  // namespace eventide
