// Events that come a little out of order, put in order.
#pragma once

#include "src/core/event.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace eventide {

/// Holds events until one comes that is more than `window` later, and hands them on sorted; those
/// of one time stay in the order in which they came. An event more than `window` before the newest
/// is handed on at once: it is too late, and whoever takes it judges it. A leap in time hands on
/// all that is held, so that one wrong time does not keep all after it from being sorted.
class Reorder {
public:
    static constexpr std::int64_t kLeap = 100'000;                 // us
    static constexpr std::size_t kMaxHeld = std::size_t{1} << 20;  // 24 MiB at most

    explicit Reorder(SensorDuration window)
        : window_(window.count()), leap_(std::max(kLeap, window_)) {}

    /// take(event) for each that is due; some wait for drain().
    template <typename Take>
    void push(const Event& event, Take&& take) {
        if (window_ == 0) return take(event);
        const std::int64_t t = to_us(event.t);
        if (is_empty()) return begin_with(event);
        const bool late = is_more(t, newest_, window_);
        if (is_more(newest_, t, leap_) || (late && !confirmed_)) {
            flush(take);
            return begin_with(event);
        }
        if (late || n_held() >= next_drain_) drain(take);
        if (late) return take(event);
        if (n_held() >= kMaxHeld) take_first(take);
        confirmed_ = true;
        insert(event, t);
    }

    /// Hands on what is due by now. How often does not change what comes out.
    template <typename Take>
    void drain(Take&& take) {
        while (!is_empty() && is_more(first_us(), newest_, window_)) take_first(take);
        if (head_ > held_.size() / 2) {
            held_.erase(held_.begin(), held_.begin() + std::ptrdiff_t(head_));
            head_ = 0;
        }
        next_drain_ = std::clamp(2 * n_held(), kFewest, kMaxHeld);
    }

    /// Hands on all.
    template <typename Take>
    void flush(Take&& take) {
        while (!is_empty()) take_first(take);
        held_.clear();
        head_ = 0;
        next_drain_ = kFewest;
    }

    bool is_empty() const { return n_held() == 0; }
    /// The newest time, where more than one event tells it.
    std::optional<std::int64_t> newest_us() const {
        return !is_empty() && confirmed_ ? std::optional(newest_) : std::nullopt;
    }

private:
    static constexpr std::size_t kFewest = 4096;  // events before it is worth looking

    /// Times as far apart as 64 bits allow.
    static bool is_more(std::int64_t earlier, std::int64_t later, std::int64_t than) {
        return later > earlier &&
               std::uint64_t(later) - std::uint64_t(earlier) > std::uint64_t(than);
    }

    struct Late {
        Event event;
        std::uint64_t number;
        friend bool operator<(const Late& a, const Late& b) {  // for a heap with the first on top
            return a.event.t > b.event.t || (a.event.t == b.event.t && a.number > b.number);
        }
    };

    std::size_t n_held() const { return held_.size() - head_ + late_.size(); }
    /// Whether the earliest event held is one that came late. Of one time, the event that came in
    /// order was first: a late one came after a later time.
    bool late_is_first() const {
        return !late_.empty() && (head_ == held_.size() || late_.front().event.t < held_[head_].t);
    }
    std::int64_t first_us() const {
        return to_us(late_is_first() ? late_.front().event.t : held_[head_].t);
    }

    template <typename Take>
    void take_first(Take&& take) {
        if (!late_is_first()) return take(held_[head_++]);
        std::pop_heap(late_.begin(), late_.end());
        take(late_.back().event);
        late_.pop_back();
    }

    void insert(const Event& event, std::int64_t t) {
        if (t >= newest_) {
            newest_ = t;
            held_.push_back(event);
        } else {
            late_.push_back({event, late_number_++});
            std::push_heap(late_.begin(), late_.end());
        }
    }

    void begin_with(const Event& event) {
        held_.push_back(event);
        newest_ = to_us(event.t);
        confirmed_ = false;
    }

    std::int64_t window_, leap_;  // us
    std::vector<Event> held_;     // from head_ on; came in order
    std::vector<Late> late_;      // a heap; came after later ones
    std::uint64_t late_number_ = 0;
    std::size_t head_ = 0, next_drain_ = kFewest;
    std::int64_t newest_ = 0;  // of the events held, us
    bool confirmed_ = false;   // another event was within the window of the first held
};

}  // namespace eventide
