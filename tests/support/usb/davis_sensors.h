// Cameras that tests speak of by name. A DavisSensor is a DAVIS346 where nothing else is said.
#pragma once

#include "src/codec/inivation/davis.h"

namespace eventide::testing_support {

inline DavisSensor davis240() {
    DavisSensor sensor;
    sensor.chip = DavisChip::davis240c;
    sensor.dvs_columns = sensor.aps_columns = 240;
    sensor.dvs_rows = sensor.aps_rows = 180;
    sensor.dvs_swapped = sensor.aps_swapped = false;
    return sensor;
}

}  // namespace eventide::testing_support
