// What a caller pushes -> event windows: hostile events are left out and counted, the rest is cut.
#pragma once

#include "pipeline/filters/event_filter.h"
#include "src/binning/slicer.h"

#include <eventide/reconstructor.h>

#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace eventide {

/// Adds to the counters of whoever owns it; everything is borrowed but the filter.
class EventIntake {
public:
    using Clock = HostTime::clock;

    /// `filter` may be null.
    EventIntake(const SlicerSettings& settings, int width, int height,
                std::unique_ptr<EventFilters> filter, ReconstructorCounters& counters);

    /// A step back in time is disorder.
    void push(std::span<const Event> events, HostTime arrived = Clock::now());
    /// A step back in time is a clock reset.
    void push(const Batch& batch, HostTime arrived = Clock::now());
    void advance(SensorTime now);
    void mark_gap() noexcept { slicer_.mark_gap(); }
    void finish(std::optional<SensorTime> end);
    bool is_finished() const { return finished_; }
    bool next(EventWindow& event_window) { return slicer_.next(event_window); }

    /// Images pushed from now on are held for next_image(); before, only their times are used.
    void hold_images() { holds_images_ = true; }
    /// The next image, in grey, of those that had been pushed when the event window given last
    /// could first be cut: the same images however late the window is taken.
    std::optional<ReferenceImage> next_image();
    bool has_images() const { return !images_.empty(); }

    void reset();

private:
    enum class StepBack { is_disorder, is_new_clock };
    void hold(const ReferenceImage& image);
    void take(std::span<const Event> events, StepBack step_back, HostTime arrived);
    bool is_sound(const Event& event);
    void check_open(const char* what) const;
    void note_cut();

    const unsigned width_, height_;
    Slicer slicer_;
    std::unique_ptr<EventFilters> filter_;
    ReconstructorCounters& counters_;
    std::vector<Event> taken_;
    std::optional<SensorTime> newest_;
    struct Image {
        ReferenceImage image;
        Slicer::Position since;  // what was known before it came
    };
    std::deque<Image> images_;
    bool holds_images_ = false, finished_ = false;
};

}  // namespace eventide
