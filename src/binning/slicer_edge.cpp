// Where the open event window ends.
#include "src/binning/slicer.h"

#include <algorithm>

namespace eventide {
namespace {

constexpr SensorDuration kMicrosecond{1};

}  // namespace

/// Every event at or before this time is known.
SensorTime Slicer::passed() const {
    if (pending_.segment_has_ended()) return pending_.segment_final();
    if (finished_ || past_end_) return newest_;
    return newest_ - kMicrosecond;  // more events of the newest microsecond may come
}

Slicer::Position Slicer::heard() const {
    if (!begin_ || newest_ == SensorTime::min()) return {clocks_heard_, std::nullopt};
    return {clocks_heard_, past_end_ ? newest_ : newest_ - kMicrosecond};
}

bool Slicer::ended_before(const Position& position) const {
    if (position.clocks != clocks_given_) return position.clocks > clocks_given_;
    return position.until && begin_ && *position.until >= *begin_;
}

std::optional<SensorTime> Slicer::next_reference() {
    const auto first = std::ranges::upper_bound(references_, Reference{clocks_given_, *begin_});
    references_.erase(references_.begin(), first);
    if (references_.empty() || references_.front().clock != clocks_given_) return std::nullopt;
    return references_.front().t;
}

/// Rule content: the time at which the open window has seen enough, where it is known.
std::optional<SensorTime> Slicer::busy_at() {
    const auto busy = activity_.busy_at(pending_.segment());
    if (!busy) return std::nullopt;
    return std::max(*busy, *begin_ + settings_.min_width);
}

SensorTime Slicer::natural_edge() const {
    if (settings_.rule != WindowRule::duration) return *begin_ + step_;
    return origin_ + ((*begin_ - origin_) / step_ + 1) * step_;
}

/// Of an empty window that reaches into a long silence, at most until `limit`. A filter may hold
/// events back: what it will give does not count, so that windows do not hang on when it does.
SensorTime Slicer::widened(SensorTime edge, SensorTime limit) const {
    const auto events = pending_.segment();
    if (!events.empty())
        limit = std::min(limit, events.front().t - kMicrosecond);
    else if (is_ended())
        limit = std::min(limit, passed());
    return silence_.widened(edge, limit);
}

/// The end of the open window, where it is known.
std::optional<SensorTime> Slicer::cut() {
    const SensorTime passed = this->passed();
    SensorTime edge = natural_edge(), limit = SensorTime::max();
    SensorDuration wait{0};
    if (settings_.rule == WindowRule::reference) {
        if (const auto reference = next_reference())
            edge = std::min(edge, limit = *reference);
        else if (!is_ended())
            wait = settings_.reference_wait;
    }
    if (settings_.rule == WindowRule::content)
        if (const auto busy = busy_at()) edge = std::min(edge, *busy);
    edge = widened(edge, limit);
    if (const auto events = pending_.segment(); events.size() >= most_events_) {
        const SensorTime last = events[most_events_ - 1].t;
        if (last <= edge) {
            edge = last;
            wait = SensorDuration{0};
        }
    }
    if (passed - wait >= edge) return edge;
    if (is_ended() && *begin_ < passed) return passed;
    return std::nullopt;
}

}  // namespace eventide
