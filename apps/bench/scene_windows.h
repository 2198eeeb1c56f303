// A simulated scene cut into event windows, as input for measurements.
#pragma once

#include "src/core/frame_data.h"
#include "src/simulate/sim_recording.h"

#include <vector>

namespace eventide::bench {

struct SceneWindow {
    Window window;
    std::vector<Event> events;
    EventWindow event_window() const { return {.window = window, .events = events}; }
};

/// Consecutive event windows of 50 ms of the settings' scene, its first 0.2 s left out.
std::vector<SceneWindow> scene_windows(const SimRecordingSettings& settings, int count);

}  // namespace eventide::bench
