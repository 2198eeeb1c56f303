// A look into a recording before anything is written: does it hold what was asked for?
#pragma once

#include "apps/cli/settings/time_point.h"
#include "replay/open_options.h"
#include "src/binning/slicer_settings.h"
#include "src/core/sensor_time.h"

#include <optional>
#include <string>

namespace eventide::app {

/// The part asked of a recording: as the user said it, and as times of its clock.
struct AskedPart {
    std::string source;
    OpenOptions options;
    std::optional<TimePoint> from_said;
    std::optional<SensorTime> from, to;
};

/// Throws Error (usage) where the end lies before the beginning.
void check_order(std::optional<SensorTime> from, std::optional<SensorTime> to);

/// check_order(), and throws Error (usage) where a recording has no event from --from on, or none
/// until the end. Live sources and what can be read but once are not looked at.
void check_part(const AskedPart& part);

/// Throws Error (usage) where --window aps finds no image in a recording, which is looked into as
/// above.
void check_images(const AskedPart& part, const SlicerSettings& slicer);

}  // namespace eventide::app
