// The size of the sensor where a recording does not say it: from the events themselves.
#pragma once

#include "replay/file_recording.h"
#include "src/core/sensor_limits.h"

namespace eventide {

/// Reads the whole file once, in bounded memory, and sets width and height of the header to those
/// of the smallest known sensor that holds all its events but damaged ones (one in a thousand), and
/// says so in the remarks. Throws Error (input) where there is no event or no such sensor: one bad
/// coordinate may not make a run allocate gigabytes.
void scan_geometry(const ByteFile& file, OpenedStream& stream);

}  // namespace eventide
