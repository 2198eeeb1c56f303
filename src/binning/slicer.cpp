// stream of events -> event windows (slicer_edge.cpp: where each one ends).
#include "src/binning/slicer.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace eventide {
namespace {

constexpr SensorDuration kMicrosecond{1};

}  // namespace

Slicer::Slicer(const SlicerSettings& settings, int width, int height)
    : width_(width), height_(height) {
    adopt(settings);
    reset();
}

void Slicer::adopt(const SlicerSettings& settings) {
    check_slicer_settings(settings, width_, height_);
    if (settings.rule == WindowRule::content)
        activity_ = {settings.events_per_pixel, width_, height_};
    settings_ = settings;
    step_ = natural_width(settings);
    most_events_ = events_per_window(settings, width_, height_);
    silence_.set_windows(step_, settings.silent_windows);
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
}

void Slicer::reset() {
    pending_.clear();
    references_.clear();
    gaps_.clear();
    begin_.reset();
    activity_.reset();
    silence_.reset();
    newest_ = newest_event_ = SensorTime::min();
    same_time_ = clocks_heard_ = clocks_given_ = 0;
    behind_since_.reset();
    reset_ = anew_ = finished_ = past_end_ = false;
    first_stream_ = true;
    end_ = settings_.end;
    hears_apart_ = false;
    heard_event_ = SensorTime::min();
    if (settings_.begin) begin_at(*settings_.begin);
}

void Slicer::begin_at(SensorTime begin) {
    begin_ = origin_ = begin;
    newest_ = std::max(newest_, begin);
    silence_.begin_at(begin);
    if (first_stream_ && settings_.duration && !settings_.end) end_ = begin + *settings_.duration;
}

void Slicer::push(std::span<const Event> events, HostTime arrived) {
    assert(!finished_);
    pending_.drop_taken();
    if (!events.empty()) arrived_ = arrived;
    for (const Event& event : events) push_one(event);
}

void Slicer::hear(std::span<const Event> events) {
    hears_apart_ = true;
    if (!begin_ && !events.empty()) begin_at(events.front().t - kMicrosecond);
    for (const Event& event : events) silence_.see(event.t);
    if (!events.empty()) heard_event_ = events.back().t;
}

void Slicer::begin_anew(SensorTime first) {
    anew_ = false;
    const bool has_reached_begin = !first_stream_ || !settings_.begin ||
                                   std::max(heard_event_, newest_event_) > *settings_.begin;
    heard_event_ = SensorTime::min();
    if (!has_reached_begin) return;
    note_time(silence_.newest());
    if (past_end_) return;
    ++counters_.time_resets;
    ++clocks_heard_;
    const SensorTime final = std::max(newest_, newest_event_), begin = first - kMicrosecond;
    pending_.end_segment(final, begin);
    first_stream_ = false;
    end_ = end_after_reset(final, begin);
    newest_ = begin;
    newest_event_ = SensorTime::min();
    same_time_ = 0;
    silence_.hear_anew();
}

void Slicer::push_one(const Event& event) {
    // The parser keeps order, so where time goes back the camera's clock was reset.
    if (anew_ || (hears_apart_ ? event.t < newest_event_ : is_new_clock(newest_event_, event.t)))
        begin_anew(event.t);
    if (!hears_apart_) silence_.see(event.t);
    if (first_stream_ && settings_.begin && event.t <= *settings_.begin) {
        ++counters_.before_begin;
        return;
    }
    note_time(event.t);
    if (past_end_) {
        ++counters_.after_end;
        return;
    }
    same_time_ = event.t == newest_event_ ? same_time_ + 1 : 1;
    newest_event_ = event.t;
    if (same_time_ > settings_.max_events) {
        ++counters_.too_many;
        return;
    }
    if (!begin_) begin_at(event.t - kMicrosecond);
    Event kept = event;
    // advance() promised too much, or hear() began with the time before a reset of the clock.
    if (!pending_.segment_has_ended() && kept.t <= *begin_) {
        ++counters_.late;
        kept.t = *begin_ + kMicrosecond;
        newest_ = std::max(newest_, kept.t);
    }
    pending_.push(kept);
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
    if (now > silence_.newest()) silence_.see(now);
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

void Slicer::finish() {
    if (begin_) note_time(silence_.newest());
    finished_ = true;
}

void Slicer::push_reference(SensorTime t) {
    if (settings_.rule != WindowRule::reference) return;
    const Reference told{clocks_heard_, t};
    if (begin_ && told.clock == clocks_given_ && t <= *begin_) {
        if (t > origin_) ++counters_.late_references;  // else before all events
        return;
    }
    references_.insert(std::ranges::upper_bound(references_, told), told);
}

void Slicer::emit(SensorTime end, EventWindow& event_window) {
    event_window.window = {*begin_, end};
    event_window.events = pending_.take_until(end);
    event_window.reset_before = std::exchange(reset_, false);
    event_window.arrived = arrived_;
    begin_ = end;
    const auto after =
        std::ranges::find_if(gaps_, [this](const Position& gap) { return ended_before(gap); });
    event_window.gap_before = after != gaps_.begin();
    gaps_.erase(gaps_.begin(), after);
    activity_.reset();
    silence_.end_window(event_window.events.empty());
    silence_.forget_pauses_until(end);
}

/// Goes on where the camera's clock was reset.
void Slicer::begin_next_segment() {
    begin_ = origin_ = pending_.next_segment();
    ++clocks_given_;
    silence_.begin_anew();
    reset_ = true;
}

bool Slicer::next(EventWindow& event_window) {
    while (begin_) {
        if (const auto end = cut()) {
            emit(*end, event_window);
            return true;
        }
        if (!pending_.segment_has_ended()) return false;
        begin_next_segment();
    }
    return false;
}

}  // namespace eventide
