// The size of the sensor where a recording does not say it: from the events themselves.
#pragma once

#include "replay/file_recording.h"

namespace eventide {

/// Larger coordinates than any sensor has are damage and not taken for the size.
constexpr int kLargestSensorSide = 4096;

/// Reads the whole file once, in bounded memory, and sets width and height of the header to the
/// largest coordinates plus one. Throws Error (input) when there is no event.
void scan_geometry(const ByteFile& file, OpenedStream& stream);

}  // namespace eventide
