// Events between parser and event window.
#include "src/binning/pending_events.h"

#include <algorithm>
#include <cassert>

namespace eventide {

std::span<const Event> PendingEvents::segment() const {
    const std::size_t end = ends_.empty() ? events_.size() : ends_.front().index;
    return std::span{events_}.subspan(taken_, end - taken_);
}

std::span<const Event> PendingEvents::take_until(SensorTime end) {
    const auto left = segment();
    const auto first_after =
        std::upper_bound(left.begin(), left.end(), end,
                         [](SensorTime t, const Event& event) { return t < event.t; });
    const auto taken = left.first(std::size_t(first_after - left.begin()));
    taken_ += taken.size();
    return taken;
}

SensorTime PendingEvents::next_segment() {
    assert(taken_ == ends_.front().index);
    const SensorTime begin = ends_.front().begin;
    ends_.erase(ends_.begin());
    return begin;
}

void PendingEvents::drop_taken() {
    if (taken_ == 0) return;
    events_.erase(events_.begin(), events_.begin() + std::ptrdiff_t(taken_));
    for (End& end : ends_) end.index -= taken_;
    taken_ = 0;
}

void PendingEvents::assign(std::span<const Event> events) {
    events_.assign(events.begin(), events.end());
    taken_ = 0;
    ends_.clear();
}

}  // namespace eventide
