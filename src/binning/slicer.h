// stream of events -> event windows: consecutive windows (begin, end] without holes.
#pragma once

#include "src/binning/pending_events.h"
#include "src/binning/silence_tracker.h"
#include "src/binning/slicer_settings.h"
#include "src/binning/tile_activity.h"
#include "src/core/frame_data.h"

#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace eventide {

/// Events taken in that are in no event window, or not at their own time; by reason.
struct SlicerCounters {
    std::uint64_t before_begin = 0;     ///< left out: before SlicerSettings::begin
    std::uint64_t after_end = 0;        ///< left out: after SlicerSettings::end
    std::uint64_t too_many = 0;         ///< left out: more than max_events in one microsecond
    std::uint64_t late = 0;             ///< moved to the open window's first microsecond
    std::uint64_t late_references = 0;  ///< images before the open window: no edge was cut there
    std::uint64_t time_resets = 0;      ///< clock resets, each of which began a new stream
};

/// Give it what the stream says, then take event windows until there is none:
///
///     slicer.push(events);
///     for (EventWindow event_window; slicer.next(event_window);) ...
///
/// A window is cut at T when the stream is past T. However the stream is split into calls, the
/// event windows are the same (with the exception that SlicerSettings::silent_windows states).
///
/// Clock reset: the sensor's clock starts again, which shows in an event's time that steps back, as
/// events are in order otherwise. It ends the open window, and a new stream begins, whose first
/// event window carries reset_before.
class Slicer {
public:
    /// Sensor of width x height px. Throws Error (usage) for settings out of range.
    Slicer(const SlicerSettings& settings, int width, int height);

    /// Events in the order of the stream; `arrived` of the packet they came in.
    void push(std::span<const Event> events, HostTime arrived = {});

    /// Where a filter leaves out events: tells the times of all of them, in order. Call it before
    /// push() with those that are left, and advance() after it. So windows in silence, too, are the
    /// same however the stream is split.
    void hear(std::span<const Event> events);
    /// Whether an event at t, the next after one at `before`, shows a clock reset: time went back,
    /// or farther ahead than limit_leap() allows.
    bool is_new_clock(SensorTime before, SensorTime t) const {
        return t < before || (before != SensorTime::min() && t - before > most_ahead_);
    }
    /// From now on an event more than `most` after the one before it is a clock reset. No limit at
    /// first: a recording may be silent for hours.
    void limit_leap(SensorDuration most) { most_ahead_ = most; }
    /// Whether an event at t, the next after those given to hear(), shows a clock reset.
    bool begins_anew(SensorTime t) const { return anew_ || is_new_clock(heard_event_, t); }
    /// Clock reset: the open window ends, and a new stream begins with an event at `first`. push()
    /// does this by itself; call it where the event that shows it may be left out by a filter.
    void begin_anew(SensorTime first);

    /// The time of a reference image; before or after the events around it. Other rules ignore it.
    void push_reference(SensorTime t);

    /// The stream's clock says `now`: no event before it will come any more.
    void advance(SensorTime now, HostTime arrived = {});

    /// For live sources: tells the time of the newest data that came, before their events are
    /// pushed. Where advance() went on by the host's clock while the source stood still (a
    /// recording somewhere that was paused), the source's times never catch up: once they have been
    /// more than kMostBehind behind for as long on the host's clock, the next event is a clock
    /// reset.
    static constexpr SensorDuration kMostBehind{1'000'000};
    void look_behind(SensorTime told, HostTime arrived);

    /// A place in the stream.
    struct Position {
        std::uint64_t clocks = 0;           ///< clock resets before it
        std::optional<SensorTime> until{};  ///< every event up to then was known; empty: none was
        friend bool operator==(const Position&, const Position&) = default;
    };
    /// Bytes were lost here. The next event window carries gap_before.
    void mark_gap() {
        const Position here = heard();
        if (gaps_.empty() || gaps_.back() != here) gaps_.push_back(here);
    }

    /// Nothing more will come: what is open ends at the newest time known.
    void finish();

    /// The open event window and those after it are cut so: rule, width, events, events_per_pixel,
    /// min_width and max_width; the rest stays as constructed. Throws Error (usage) for settings
    /// out of range, and stays as it was.
    void change(const SlicerSettings& wanted);

    /// The next complete event window, borrowed until the next call of anything here.
    bool next(EventWindow& event_window);

    /// Where the stream stands: the latest time that push() and advance() told so far (less 1 us,
    /// as more events of that microsecond may come), and the clock resets until then.
    Position heard() const;
    /// Whether the event window given last could already be cut when the stream stood at
    /// `position`, however late it was.
    bool ended_before(const Position& position) const;

    bool has_begun() const { return begin_.has_value(); }
    bool is_past_end() const { return past_end_; }  ///< end() was reached
    /// SlicerSettings::end or duration as a time of the present clock: later events are left out.
    /// Empty: none are, or not known yet.
    std::optional<SensorTime> end() const { return end_; }
    /// Whether there was a clock reset after SlicerSettings::begin: begin and end of the settings
    /// are then times of a clock that is gone.
    bool began_anew() const { return !first_stream_; }
    const SlicerCounters& counters() const { return counters_; }

    /// As constructed; counters stay.
    void reset();

    /// The open window, from which another slicer can go on. Only of a stream without clock resets.
    struct State {
        SensorTime begin{}, origin{};  ///< of the open window; of the edges of rule duration
        SensorTime newest{}, newest_event{};
        SensorTime heard{};  ///< newest time told, also by events that a filter holds back
        std::uint64_t same_time = 0;
        int silent = 0;
        bool gap = false;
        std::vector<Event> events;  ///< of the open window, in order
        friend bool operator==(const State&, const State&) = default;
    };
    /// Call it once next() gives no more event window. Empty before anything came, after a clock
    /// reset, and with rule reference, which remembers images.
    std::optional<State> state() const;
    /// Goes on from `state`, which is of a slicer with the same settings; this one has seen
    /// nothing. `begin` and `end` of the settings hold for what comes. Throws Error (input) for a
    /// state that cannot be true, and is then as it was.
    void restore(const State& state);

private:
    void adopt(const SlicerSettings& settings);
    void push_one(const Event& event);
    void begin_at(SensorTime begin);
    std::optional<SensorTime> end_after_reset(SensorTime final, SensorTime begin) const;
    void note_time(SensorTime t);
    void emit(SensorTime end, EventWindow& event_window);
    void begin_next_segment();

    // Where the open event window ends.
    bool is_ended() const { return finished_ || past_end_ || pending_.segment_has_ended(); }
    SensorTime passed() const;
    std::optional<SensorTime> cut();
    std::optional<SensorTime> next_reference();
    std::optional<SensorTime> busy_at();
    SensorTime natural_edge() const;
    SensorTime widened(SensorTime edge, SensorTime limit) const;

    int width_, height_;  // px
    SlicerSettings settings_;
    SensorDuration step_;        // width of a window without events
    std::uint64_t most_events_;  // per window

    PendingEvents pending_;
    TileActivity activity_;  // rule content: of the open window
    SilenceTracker silence_;
    /// Which clock tells an image's time: the value of clocks_heard_ when it came.
    struct Reference {
        std::uint64_t clock;
        SensorTime t;
        auto operator<=>(const Reference&) const = default;  // NOLINT(modernize-use-nullptr)
    };
    std::vector<Reference> references_;  // ascending
    std::vector<Position> gaps_;         // that no window given carries yet
    std::optional<SensorTime> begin_;    // of the open window
    SensorTime origin_{};                // rule duration: edges are at origin_ + k width
    SensorTime newest_ = SensorTime::min(), newest_event_ = SensorTime::min();
    std::uint64_t same_time_ = 0;  // events at newest_event_
    // Clock resets: in what was pushed, in the windows given.
    std::uint64_t clocks_heard_ = 0, clocks_given_ = 0;
    bool hears_apart_ = false;                    // hear() tells the time, not push()
    SensorTime heard_event_ = SensorTime::min();  // the last by hear()
    SensorDuration most_ahead_ = SensorDuration::max();
    HostTime arrived_{};
    std::optional<HostTime> behind_since_;  // the stream is far behind newest_
    bool reset_ = false, anew_ = false, finished_ = false, past_end_ = false;
    bool first_stream_ = true;       // settings_.begin and end are times of the first stream only
    std::optional<SensorTime> end_;  // of the clock at hand
    SlicerCounters counters_;
};

}  // namespace eventide
