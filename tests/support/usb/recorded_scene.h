// A recording as something that a camera in software sees.
#pragma once

#include "replay/recording.h"
#include "src/codec/inivation/davis_sensor.h"
#include "src/core/event.h"

namespace eventide::testing_support {

/// All that is in the recording, as a DAVIS can tell it: from time zero, because a camera counts
/// from its reset; grey images only.
Batch scene_of(Recording& recording);

/// A DAVIS240 for recordings of 240x180, else a DAVIS346. Throws Error (usage) for larger ones.
DavisSensor sensor_for(const SensorInfo& info);

}  // namespace eventide::testing_support
