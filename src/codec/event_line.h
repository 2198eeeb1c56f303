// The rules every event passes: inside the sensor, not before the one before it, no lone leap.
#pragma once

#include "src/core/damage.h"
#include "src/core/event.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace eventide {

/// Takes events in the order of the stream. A leap of more than kLongestStep is believed when what
/// follows does not lie before it; else it counts as bad_record: one flipped bit would otherwise
/// put all that follows in the past. What follows is the next event or, where events come in
/// packets that are damaged as a whole, the next packet: until then all after the leap is held.
class EventLine {
public:
    enum class LeapEnds { with_next_event, with_next_packet };
    static constexpr std::int64_t kLongestStep = 100'000;  // us; no more is lost to one bad time

    /// px
    EventLine(std::uint64_t width, std::uint64_t height,
              LeapEnds leap_ends = LeapEnds::with_next_event)
        : width_(width), height_(height), leap_ends_(leap_ends) {}

    void add(std::int64_t t_us, std::uint64_t x, std::uint64_t y, bool on, Batch& into,
             Damage& damage) {
        if (x >= width_ || y >= height_) {
            damage.count(DamageReason::out_of_range);
            return;
        }
        const Event event{from_us(t_us), std::uint16_t(x), std::uint16_t(y), Polarity(on)};
        if (!held_.empty() || is_leap(t_us)) {
            add_after_leap(event, into, damage);
        } else if (newest_ && t_us < *newest_) {
            damage.count(DamageReason::time_backwards);
        } else {
            newest_ = t_us;
            into.events.push_back(event);
        }
    }

    /// Of packets: what comes next is in another.
    void end_packet() { in_packet_of_leap_ = false; }

    /// The stream ended: nothing can contradict the events held back.
    void finish(Batch& into) { take_held(into); }

    /// Takes up anywhere in time.
    void resync() {
        held_.clear();
        newest_.reset();
    }

    std::uint64_t width() const { return width_; }
    std::uint64_t height() const { return height_; }
    std::optional<std::int64_t> newest_us() const { return newest_; }  ///< of the events taken

    /// For a loop of its own over many events: true when this time needs no more than a look.
    bool is_plain(std::int64_t t_us) const {
        return newest_ && held_.empty() && t_us >= *newest_ && t_us - *newest_ <= kLongestStep;
    }
    void pass(std::int64_t t_us) { newest_ = t_us; }  ///< after is_plain()

private:
    bool is_leap(std::int64_t t_us) const {
        return newest_ && t_us > *newest_ &&
               std::uint64_t(t_us) - std::uint64_t(*newest_) > std::uint64_t(kLongestStep);
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
            take_held(into);
        }
        add(to_us(event.t), event.x, event.y, event.polarity == Polarity::on, into, damage);
    }

    std::uint64_t width_, height_;
    std::optional<std::int64_t> newest_;  ///< us
    std::vector<Event> held_;             ///< after a leap, until it is believed or not
    LeapEnds leap_ends_;
    bool in_packet_of_leap_ = false;
};

}  // namespace eventide
