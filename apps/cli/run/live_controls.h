// What viewers of the live page may change, made out of the settings of a run.
#pragma once

#include "apps/cli/settings/run_settings.h"
#include "pipeline/live_changes.h"
#include "pipeline/sinks/http/control.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace eventide::app {

struct LiveControlsPlan {
    const RunSettings& settings;
    LiveChanges& changes;                        ///< borrowed by the controls
    Size sensor;                                 ///< px
    double fps = 30;                             ///< of the video, at the start
    int lookahead = 0;                           ///< at the start
    double speed = 0;                            ///< of a recording at a pace, at the start
    std::function<void(double)> set_speed = {};  ///< empty: the source has one speed
    bool live = false;
    SlicerSettings slicer = {};  ///< at the start
    /// How soon events may end a window now, where --quality has that follow the load; else 0.
    std::function<SensorDuration()> min_window = [] { return SensorDuration{0}; };
};

/// The first sink whose frames must be all alike, as it was named.
std::optional<std::string> rigid_sink(const RunSettings& settings);

/// fps, scale, lookahead, speed, window, in this order; a window in the unit of its rule. Those
/// that cannot be changed say why: windows between images are cut by those, and files and streams
/// have frames that are all alike.
std::vector<HttpControl> live_controls(const LiveControlsPlan& plan);

}  // namespace eventide::app
