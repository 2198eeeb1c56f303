// stream of events -> event windows.
#include "src/binning/slicer.h"

#include "src/core/error.h"
#include "src/core/sensor_limits.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>
#include <utility>

namespace eventide {
namespace {

constexpr SensorDuration kMicrosecond{1};

std::uint64_t events_per_window(const SlicerSettings& settings, int width, int height) {
    if (settings.rule != WindowRule::count) return settings.max_events;
    const double pixels = double(width) * double(height);
    const std::uint64_t wanted =
        settings.events_per_pixel > 0
            ? std::uint64_t(std::llround(std::max(1.0, settings.events_per_pixel * pixels)))
            : settings.events;
    return std::min(wanted, settings.max_events);
}

void check(bool good, const char* name, std::int64_t found) {
    if (!good)
        throw Error(ErrorKind::usage, std::string{"event windows: "} + name +
                                          " must be at least 1, found " + std::to_string(found));
}

}  // namespace

Slicer::Slicer(const SlicerSettings& settings, int width, int height)
    : width_(width), height_(height) {
    check(width >= 1 && height >= 1, "the sensor's size", std::min(width, height));
    adopt(settings);
    reset();
}

void Slicer::adopt(const SlicerSettings& settings) {
    const SensorDuration step =
        settings.rule == WindowRule::duration ? settings.width : settings.max_width;
    const std::uint64_t most = events_per_window(settings, width_, height_);
    check(step >= kMicrosecond, "the (maximum) width in us", step.count());
    check(most >= 1, "the number of events", std::int64_t(most));
    check(settings.silent_windows >= 1, "silent_windows", settings.silent_windows);
    if (settings.rule == WindowRule::content)
        activity_ = {settings.events_per_pixel, width_, height_};
    settings_ = settings;
    step_ = step;
    most_events_ = most;
}

void Slicer::change(const SlicerSettings& wanted) {
    SlicerSettings now = settings_;
    now.rule = wanted.rule;
    now.width = wanted.width;
    now.events = wanted.events;
    now.events_per_pixel = wanted.events_per_pixel;
    now.min_width = wanted.min_width;
    now.max_width = wanted.max_width;
    adopt(now);
    if (begin_) origin_ = *begin_;
    look_again();
}

void Slicer::reset() {
    pending_.clear();
    seams_.clear();
    references_.clear();
    head_ = 0;
    begin_.reset();
    look_again();
    newest_ = newest_event_ = SensorTime::min();
    same_time_ = 0;
    silent_ = 0;
    behind_since_.reset();
    gap_ = reset_ = anew_ = finished_ = past_end_ = false;
    first_stream_ = true;
    end_ = settings_.end;
    heard_ = SensorTime::min();
    hushes_.clear();
    hears_apart_ = false;
    if (settings_.begin) begin_at(*settings_.begin);
}

std::optional<Slicer::State> Slicer::state() const {
    if (!begin_ || newest_event_ == SensorTime::min() || !first_stream_ ||
        settings_.rule == WindowRule::reference)
        return std::nullopt;
    return State{
        *begin_,    origin_, newest_, newest_event_,
        same_time_, silent_, gap_,    {pending_.begin() + std::ptrdiff_t(head_), pending_.end()}};
}

void Slicer::restore(const State& state) {
    constexpr SensorTime kFarthest{SensorDuration{std::int64_t{1} << 60}};  // sums of times fit
    const auto in_order = [](const Event& a, const Event& b) { return a.t < b.t; };
    if (state.origin < SensorTime{-kFarthest.time_since_epoch()} || state.newest > kFarthest ||
        state.origin > state.begin || state.begin > state.newest || state.silent < 0 ||
        state.newest_event > state.newest || !std::ranges::is_sorted(state.events, in_order) ||
        (!state.events.empty() &&
         (state.events.front().t <= state.begin || state.events.back().t > state.newest_event)))
        throw Error(ErrorKind::input,
                    "event windows: expected events in order within the open window, found others");
    reset();
    begin_ = state.begin;
    origin_ = state.origin;
    newest_ = state.newest;
    newest_event_ = state.newest_event;
    heard_ = state.newest;
    same_time_ = state.same_time;
    silent_ = std::min(state.silent, settings_.silent_windows);
    gap_ = state.gap;
    pending_ = state.events;
}

void Slicer::begin_at(SensorTime begin) {
    begin_ = origin_ = begin;
    newest_ = std::max(newest_, begin);
    heard_ = std::max(heard_, begin);
    if (first_stream_ && settings_.duration && !settings_.end) end_ = begin + *settings_.duration;
}

void Slicer::push(std::span<const Event> events, HostTime arrived) {
    assert(!finished_);
    drop_consumed();
    if (!events.empty()) arrived_ = arrived;
    for (const Event& event : events) push_one(event);
}

void Slicer::hear(std::span<const Event> events) {
    hears_apart_ = true;
    if (!begin_ && !events.empty()) begin_at(events.front().t - kMicrosecond);
    for (const Event& event : events) note_heard(event.t);
}

void Slicer::note_heard(SensorTime t) {
    // Anything shorter leaves no whole window but those that come one by one anyway.
    if (heard_ != SensorTime::min() && t > heard_ + (kMaxLookahead + 1) * step_)
        hushes_.push_back({heard_, t});
    heard_ = t;
}

void Slicer::push_one(const Event& event) {
    if (!hears_apart_) note_heard(event.t);
    // The parser keeps order, so where time goes back the camera's clock was reset.
    if (const bool anew = std::exchange(anew_, false); anew || event.t < newest_event_) {
        if (past_end_) {
            ++counters_.after_end;
            return;
        }
        ++counters_.time_resets;
        const SensorTime final = std::max(newest_, newest_event_);
        seams_.push_back({pending_.size(), final});
        first_stream_ = false;
        end_ = end_after_reset(final, event.t - kMicrosecond);
        newest_ = newest_event_ = SensorTime::min();
        same_time_ = 0;
    }
    if (first_stream_ && settings_.begin && event.t <= *settings_.begin) {
        ++counters_.before_begin;
        return;
    }
    same_time_ = event.t == newest_event_ ? same_time_ + 1 : 1;
    newest_event_ = event.t;
    note_time(event.t);
    if (past_end_) {
        ++counters_.after_end;
        return;
    }
    if (same_time_ > settings_.max_events) {
        ++counters_.too_many;
        return;
    }
    if (!begin_) begin_at(event.t - kMicrosecond);
    pending_.push_back(event);
    if (seams_.empty() && event.t <= *begin_) {  // only after advance() promised too much
        ++counters_.late;
        pending_.back().t = *begin_ + kMicrosecond;
    }
}

/// A time of the first stream says nothing of the next, but what is left of a duration does.
std::optional<SensorTime> Slicer::end_after_reset(SensorTime final, SensorTime begin) const {
    if (settings_.end || !end_) return std::nullopt;
    return begin + std::max(*end_ - final, kMicrosecond);
}

void Slicer::note_time(SensorTime t) {
    if (end_ && t > *end_) {
        past_end_ = true;
        t = *end_;
    }
    newest_ = std::max(newest_, t);
}

void Slicer::advance(SensorTime now, HostTime arrived) {
    assert(!finished_);
    if (!begin_) begin_at(now - kMicrosecond);
    if (now <= newest_) return;
    arrived_ = arrived;
    if (now > heard_) note_heard(now);
    note_time(now);
}

/// What was only on its way for long (a stalled network) catches up at once.
void Slicer::look_behind(SensorTime told, HostTime arrived) {
    if (newest_ <= told + kMostBehind)
        behind_since_.reset();
    else if (!behind_since_)
        behind_since_ = arrived;
    anew_ = behind_since_ && arrived - *behind_since_ >= kMostBehind;
}

void Slicer::push_reference(SensorTime t) {
    if (settings_.rule != WindowRule::reference) return;
    if (begin_ && t <= *begin_) {
        ++counters_.late_references;
        return;
    }
    references_.insert(std::upper_bound(references_.begin(), references_.end(), t), t);
}

/// EventWindows are borrowed until the next call, so events leave only here.
void Slicer::drop_consumed() {
    if (head_ == 0) return;
    pending_.erase(pending_.begin(), pending_.begin() + std::ptrdiff_t(head_));
    for (Seam& seam : seams_) seam.index -= head_;
    head_ = 0;
}

std::size_t Slicer::segment_end() const {
    return seams_.empty() ? pending_.size() : seams_.front().index;
}

/// Every event at or before this time is known.
SensorTime Slicer::passed() const {
    if (!seams_.empty()) return seams_.front().final;
    if (finished_ || past_end_) return newest_;
    return newest_ - kMicrosecond;  // more events of the newest microsecond may come
}

std::optional<SensorTime> Slicer::next_reference() {
    const auto first = std::upper_bound(references_.begin(), references_.end(), *begin_);
    references_.erase(references_.begin(), first);
    if (references_.empty()) return std::nullopt;
    return references_.front();
}

/// Rule content: the time at which the open window has seen enough, where it is known.
std::optional<SensorTime> Slicer::busy_at() {
    for (const std::size_t end = segment_end(); !busy_ && head_ + scanned_ < end; ++scanned_)
        if (const Event& event = pending_[head_ + scanned_]; activity_.add(event)) busy_ = event.t;
    if (!busy_) return std::nullopt;
    return std::max(*busy_, *begin_ + settings_.min_width);
}

/// Another window is open: what was counted was of the one before.
void Slicer::look_again() {
    activity_.reset();
    scanned_ = 0;
    busy_.reset();
}

SensorTime Slicer::natural_edge() const {
    if (settings_.rule != WindowRule::duration) return *begin_ + step_;
    return origin_ + ((*begin_ - origin_) / step_ + 1) * step_;
}

/// The first time after `edge` that was told, where it is far from it; else `edge`.
SensorTime Slicer::told_after(SensorTime edge) const {
    for (const Hush& hush : hushes_)
        if (hush.begin <= edge && edge < hush.end) return hush.end;
    return edge;
}

/// Whole empty windows in a long silence become one (SlicerSettings::silent_windows), but for the
/// last, which frames of the wide one read. The first that was heard after the window says how far,
/// whatever else is known by now.
///
///     windows    (  ](  ] .. (  ](                         ](  ](  ](  x ]
///                silent_windows       one wide window      kMaxLookahead, and the event's
SensorTime Slicer::stretched(SensorTime edge, SensorTime passed, SensorTime limit) const {
    if (silent_ < settings_.silent_windows) return edge;
    const SensorTime silent_upto =
        head_ < segment_end() ? pending_[head_].t - kMicrosecond : passed;
    const SensorTime upto = std::min({silent_upto, limit, told_after(edge) - kMicrosecond});
    const auto more = (upto - edge) / step_ - kMaxLookahead;
    return more > 0 ? edge + more * step_ : edge;
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
        if (const auto busy = busy_at()) edge = std::min(edge, limit = *busy);
    edge = stretched(edge, passed - wait, limit);
    if (segment_end() - head_ >= most_events_) {
        const SensorTime last = pending_[head_ + most_events_ - 1].t;
        if (last <= edge) {
            edge = last;
            wait = SensorDuration{0};
        }
    }
    if (passed - wait >= edge) return edge;
    if (is_ended() && *begin_ < passed) return passed;
    return std::nullopt;
}

void Slicer::emit(SensorTime end, EventWindow& event_window) {
    const auto first = pending_.begin() + std::ptrdiff_t(head_);
    const auto last =
        std::upper_bound(first, pending_.begin() + std::ptrdiff_t(segment_end()), end,
                         [](SensorTime t, const Event& event) { return t < event.t; });
    event_window.window = {*begin_, end};
    event_window.events = {pending_.data() + head_, std::size_t(last - first)};
    event_window.gap_before = std::exchange(gap_, false);
    event_window.reset_before = std::exchange(reset_, false);
    event_window.arrived = arrived_;
    silent_ = event_window.events.empty() ? std::min(silent_ + 1, settings_.silent_windows) : 0;
    head_ += event_window.events.size();
    begin_ = end;
    // Those of a stream after the clock's next reset lie at times of their own.
    if (seams_.empty()) std::erase_if(hushes_, [end](const Hush& hush) { return hush.end <= end; });
    look_again();
}

void Slicer::cross_seam() {
    assert(head_ == seams_.front().index);
    seams_.erase(seams_.begin());
    references_.clear();
    silent_ = 0;
    reset_ = true;
    look_again();
    begin_ = origin_ = pending_[head_].t - kMicrosecond;
}

bool Slicer::next(EventWindow& event_window) {
    while (begin_) {
        if (const auto end = cut()) {
            emit(*end, event_window);
            return true;
        }
        if (seams_.empty()) return false;
        cross_seam();
    }
    return false;
}

}  // namespace eventide
