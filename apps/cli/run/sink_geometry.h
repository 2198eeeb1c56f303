// Where the frames that a sink gets lie on the sensor: for the events beside them, the truth below
// them, and camera_info.
#pragma once

#include "apps/cli/settings/run_settings.h"
#include "pipeline/calibration/calibration.h"
#include "pipeline/calibration/undistortion.h"
#include "pipeline/sinks/draw_frame.h"

#include <optional>

namespace eventide::app {

/// The part of the sensor that frames show as they are rendered, for the contact sheet. `sensor` in
/// px.
ShownPart rendered_part(const RunSettings& settings, const Size& sensor,
                        const std::optional<UndistortionPlan>& undistortion);

/// The part that frames show once cropped and flipped, as all other sinks get them, beside events
/// that are only flipped.
ShownPart shown_part(const RunSettings& settings, const Size& sensor);

/// The geometry of frames once cropped and flipped.
ImageGeometry image_geometry(const RunSettings& settings, const Size& sensor);

}  // namespace eventide::app
