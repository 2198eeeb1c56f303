// What a slicer remembers, so that another one goes on.
#include "src/binning/slicer.h"
#include "src/core/error.h"
#include "src/core/sensor_limits.h"

#include <algorithm>

namespace eventide {

std::optional<Slicer::State> Slicer::state() const {
    if (!begin_ || newest_event_ == SensorTime::min() || !first_stream_ ||
        settings_.rule == WindowRule::reference)
        return std::nullopt;
    const auto events = pending_.segment();
    return State{*begin_,
                 origin_,
                 newest_,
                 newest_event_,
                 silence_.newest(),
                 same_time_,
                 silence_.empty_windows(),
                 !gaps_.empty(),
                 {events.begin(), events.end()}};
}

void Slicer::restore(const State& state) {
    constexpr SensorTime kFarthest{SensorDuration{kFarthestUs}};
    const auto in_order = [](const Event& a, const Event& b) { return a.t < b.t; };
    if (state.heard > kFarthest || state.origin < SensorTime{-kFarthest.time_since_epoch()} ||
        state.newest > kFarthest || state.origin > state.begin || state.begin > state.newest ||
        state.silent < 0 || state.newest_event > state.newest ||
        !std::ranges::is_sorted(state.events, in_order) ||
        (!state.events.empty() &&
         (state.events.front().t <= state.begin || state.events.back().t > state.newest_event)))
        throw Error(ErrorKind::input,
                    "event windows: expected events in order within the open window, found others");
    reset();
    begin_ = state.begin;
    // What a filter held back comes yet.
    if (settings_.begin) settings_.begin = std::min(*settings_.begin, state.begin);
    origin_ = state.origin;
    newest_ = state.newest;
    newest_event_ = state.newest_event;
    same_time_ = state.same_time;
    if (state.gap) gaps_.push_back({});
    silence_.restore(state.silent, state.heard);
    pending_.assign(state.events);
}

}  // namespace eventide
