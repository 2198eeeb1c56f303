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
    std::uint64_t time_resets = 0;      ///< time went back: a new stream began
};

/// Give it what the stream says, then take event windows until there is none:
///
///     slicer.push(events);
///     for (EventWindow event_window; slicer.next(event_window);) ...
///
/// A window is cut at T when the stream is past T. However the stream is split into calls, the
/// event windows are the same (with the exception that SlicerSettings::silent_windows states).
///
/// Time that goes back (events are in order, so the camera's clock was reset) ends the open window
/// and begins anew; that event window carries reset_before.
class Slicer {
public:
    /// Sensor of width x height px. Throws Error (usage) for settings out of range.
    Slicer(const SlicerSettings& settings, int width, int height);

    /// Events in the order of the stream; `arrived` of the packet they came in.
    void push(std::span<const Event> events, HostTime arrived = {});

    /// Events of which a filter leaves out some tell the time all the same: call it with all of
    /// them, in order of time, before push() with what is left, and advance() after it. Windows in
    /// silence are then the same however the stream is split, too.
    void hear(std::span<const Event> events);
    /// Whether the event at t, after one at `before`, is told by a clock that began anew: time went
    /// back, or farther ahead than limit_leap() says.
    bool is_new_clock(SensorTime before, SensorTime t) const {
        return t < before || (before != SensorTime::min() && t - before > most_ahead_);
    }
    /// From now on. Without a limit at first: a recording may be silent for hours.
    void limit_leap(SensorDuration most) { most_ahead_ = most; }
    /// Whether an event of this time, after those heard, begins a new stream.
    bool begins_anew(SensorTime t) const { return anew_ || is_new_clock(heard_event_, t); }
    /// The camera's clock was reset: the open window ends, and a new stream begins at `first`. As
    /// push() does by itself, for who knows of events that a filter leaves out.
    void begin_anew(SensorTime first);

    /// The time of a reference image; before or after the events around it. Other rules ignore it.
    void push_reference(SensorTime t);

    /// The stream's clock says `now`: no event before it will come any more.
    void advance(SensorTime now, HostTime arrived = {});

    /// A source that stood still (a recording somewhere that was paused) never catches up with what
    /// advance() promised meanwhile by the host's clock. Tell what it says before its events are
    /// pushed: where it stays more than kMostBehind behind for as long on the host's clock, the
    /// next event begins a new stream, as where time goes back.
    static constexpr SensorDuration kMostBehind{1'000'000};
    void look_behind(SensorTime told, HostTime arrived);

    /// A place in the stream: how often its clock had begun anew, and until when all was known
    /// then.
    struct Position {
        std::uint64_t clocks = 0;
        std::optional<SensorTime> until{};  ///< empty: nothing was
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

    /// Of all that was said so far.
    Position heard() const;
    /// The end of the event window given last. It could have been cut before what came when the
    /// stream stood at `position`.
    bool ended_before(const Position& position) const;

    bool has_begun() const { return begin_.has_value(); }
    bool is_past_end() const { return past_end_; }  ///< SlicerSettings::end was reached
    /// The last time that was asked for, of the clock at hand; empty: all, or not known yet.
    std::optional<SensorTime> end() const { return end_; }
    /// Since SlicerSettings::begin, a time of the clock before.
    bool began_anew() const { return !first_stream_; }
    const SlicerCounters& counters() const { return counters_; }

    /// As constructed; counters stay.
    void reset();

    /// What is open, to go on from elsewhere. Of a stream whose clock was not reset.
    struct State {
        SensorTime begin{}, origin{};  ///< of the open window; of the edges of rule duration
        SensorTime newest{}, newest_event{};
        SensorTime heard{};  ///< until when hear() was told, which filters may hold back
        std::uint64_t same_time = 0;
        int silent = 0;
        bool gap = false;
        std::vector<Event> events;  ///< of the open window, in order
        friend bool operator==(const State&, const State&) = default;
    };
    /// Once next() gave no more event window. Empty before anything came, after a reset of the
    /// clock, and with rule reference, which remembers images.
    std::optional<State> state() const;
    /// Of a slicer of the same settings that has seen nothing; `begin` and `end` of the settings
    /// hold for what comes. Throws Error (input) for a state that holds no truth, and is then as
    /// it was.
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
    /// Which clock tells an image's time: as many had begun anew, of clocks_heard_.
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
    // Clocks that began anew: in what was pushed, in the windows given.
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
