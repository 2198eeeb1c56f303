// What the settings of a run leave to --quality, and what they ask for.
#pragma once

#include "apps/cli/run/quality/quality_choice.h"
#include "apps/cli/run/run_plan.h"

#include <optional>
#include <string>
#include <vector>

namespace eventide::app {

/// The models --quality may choose, most accurate first (docs/performance.md, "Speed against
/// error").
std::vector<std::string> models_to_choose_from(const RunSettings& settings);

/// Whether anything is chosen. Throws Error (usage) where --budget was given and there is no pace
/// to hold.
bool chooses_quality(const RunSettings& settings, bool live, double pace);

bool rate_is_open(const RunSettings& settings);
bool scale_is_open(const RunSettings& settings);

/// Frames a second of the video; 0: one for each event window.
double video_rate(const RunSettings& settings);

/// What is asked for, as one factor of the sensor's size.
QualityLevel asked_level(const RunSettings& settings, const SensorInfo& sensor);

/// Empty: as they were asked for. One frame for each window has the windows' own rate.
std::optional<SlicerSettings> windows_by_content(const RunSettings& settings,
                                                 const SlicerSettings& usual);

}  // namespace eventide::app
