// packets -> event windows: parser, filter and slicer in a row, and the clock that goes on in
// silence.
#pragma once

#include "pipeline/counters.h"
#include "pipeline/source.h"
#include "pipeline/stages.h"
#include "src/binning/slicer.h"
#include "src/core/batch_pieces.h"
#include "src/core/image_clock.h"

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace eventide {

/// Give it packets, then take event windows until there is none. Bin thread.
///
/// What closes event windows: in a recording the events alone (and at the end the parser's clock),
/// so that frames do not depend on how the file was split: in a file, what tells the clock may lie
/// before events that are older, and images may have another clock. On a live source the parser's
/// clock, too; and where the camera says nothing at all, the host's clock from the last word on,
/// less a margin.
class EventWindows {
public:
    struct Settings {
        SlicerSettings slicer;
        /// Live silence: how far sensor time that is told by the host's clock stays behind, so that
        /// what is still on its way from the camera is not late. Cameras hold back few events for
        /// some milliseconds.
        SensorDuration silence_margin{30'000};
    };

    /// Live: a clock that is farther ahead at once was set.
    static constexpr SensorDuration kMostAhead{60'000'000};

    /// filter and observer may be null; both are borrowed.
    EventWindows(const Source& source, const Settings& settings, EventFilter* filter,
                 DataObserver* observer, Counters& counters);

    void take(const RawPacket& packet);
    /// As Slicer::change(), except that what is out of range changes nothing.
    void change_window(const SlicerSettings& wanted) noexcept;
    /// For recordings: calls `at` with each of the times (ascending) once all events up to it have
    /// been pushed, and before any later one is; `at` takes the event windows that there are. Not
    /// called for times after SlicerSettings::end.
    void stop_at(std::vector<SensorTime> times, std::function<void(SensorTime)> at);
    /// Slicer::state().
    std::optional<Slicer::State> state() const { return slicer_.state(); }
    /// Goes on from a state() taken at a stop at t: events up to t are left out, should the source
    /// give them again.
    /// Throws as Slicer::restore().
    void resume(SensorTime t, const Slicer::State& memory);
    /// After the last packet. Where the end was asked for, half a record in hand is no damage.
    enum class End { of_source, asked_for };
    void finish(End end);
    bool next(EventWindow& event_window);
    /// How many images of the stream had come when the event window given last could first be cut:
    /// the same number however late the window is taken.
    std::uint64_t images() const { return images_; }
    bool is_past_end() const { return slicer_.is_past_end(); }
    std::optional<SensorTime> end() const { return slicer_.end(); }  ///< Slicer::end()
    bool clock_began_anew() const { return slicer_.began_anew(); }   ///< Slicer::began_anew()

private:
    void pass_on(HostTime arrived);
    void pass_on_piece(HostTime arrived);
    void leave_out_known();
    void stop(HostTime arrived);
    void push(std::vector<Event>& events, HostTime arrived);
    void advance_clock(HostTime arrived);
    void advance_in_silence(HostTime now);
    void look_behind(HostTime arrived);
    void limit_leap(HostTime arrived);
    void advance(SensorTime now, HostTime arrived);

    std::unique_ptr<Parser> parser_;
    Slicer slicer_;
    EventFilter* filter_;
    DataObserver* observer_;
    Counters& counters_;
    Batch batch_, piece_;
    BatchPieces pieces_;
    ImageClock image_clock_;
    std::deque<Slicer::Position> images_since_;  // what was known before each that no window knows
    std::uint64_t images_ = 0;
    std::optional<SensorTime> resumed_at_;  // until an event after it has come
    std::vector<SensorTime> stops_;         // descending
    std::function<void(SensorTime)> at_stop_;
    std::vector<Event> part_;      // of a piece, up to a stop
    std::vector<Event> released_;  // by the filter
    const bool live_;
    const SensorDuration silence_margin_;
    std::optional<SensorTime> clock_;    // the newest the stream told
    HostTime clock_arrived_{};           // when it did
    std::optional<HostTime> last_data_;  // when bytes last came
    std::optional<HostTime> last_events_;
};

}  // namespace eventide
