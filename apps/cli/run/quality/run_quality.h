// The quality of one run: chosen at its start, changed while it goes on, and said.
#pragma once

#include "apps/cli/run/quality/quality_control.h"
#include "apps/cli/run/quality/quality_report.h"
#include "apps/cli/run/run_plan.h"
#include "pipeline/counters.h"
#include "pipeline/live_changes.h"
#include "pipeline/sinks/http/control.h"

#include <atomic>
#include <functional>
#include <mutex>
#include <optional>
#include <vector>

namespace eventide::app {

class RunQuality {
public:
    struct Place {
        SensorInfo sensor;
        Span span;
        bool as_live = false;  ///< a camera, or a recording as one
        double pace = 0;       ///< sensor time over that of the clock; 0: none
        bool chooses = false;
    };
    /// Puts what is left open into `settings`: model, precision, event windows, size, and with
    /// --budget the threads; measures the processor where the cache has nothing. What was chosen is
    /// said in the log, as a warning where nothing holds. Throws Error (input, usage, failed).
    RunQuality(RunSettings& settings, const Place& place, const std::function<bool()>& give_up);

    bool changes_while_running() const { return control_.has_value(); }
    unsigned halvings() const { return state_.level.halvings; }  ///< before the run
    /// Frames a second of the video, to be said; 0: one for each event window. Any thread.
    void tell_rate(double frames_per_second);

    /// Asks `changes` for what the work so far calls for. Status thread, before the run ends.
    void look(const Snapshot& now, std::chrono::duration<double> elapsed, double pace,
              LiveChanges& changes);
    /// Once a viewer sets rate, scale or windows by these controls nothing is changed any more;
    /// state() has what was set, and the scale that is shown is that of now. Before the run;
    /// `changes` and this outlive the controls.
    void follow(std::vector<HttpControl>& controls, LiveChanges& changes);
    QualityState state() const;  ///< any thread

private:
    struct Chosen;
    Chosen choose(RunSettings& settings, const Place& place, const std::function<bool()>& give_up);
    QualityDemand demand_of(const RunSettings& settings, const Place& place,
                            const SlicerSettings& slicer) const;
    void begin_control(const RunSettings& settings, const Chosen& chosen);
    void say() const;
    void take_over(LiveChanges& changes);
    void tell_scale(double scale);

    mutable std::mutex mutex_;
    QualityState state_;
    std::optional<QualityControl> control_;  // none: nothing is changed while it runs
    Size sensor_;
    SlicerSettings slicer_;  // how windows are cut, where that is changed
};

}  // namespace eventide::app
