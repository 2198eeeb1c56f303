// Where in a file a time lies, found by bisection.
#pragma once

#include "replay/file_recording.h"

namespace eventide {

/// A byte position, at a record's start, before which no event at or after `t` lies. The beginning
/// of the data where the format cannot start in the middle, or where the times found on the way
/// contradict each other (a clock that wrapped or was reset).
std::uint64_t find_position(const ByteFile& file, const OpenedStream& stream, SensorTime t);

}  // namespace eventide
