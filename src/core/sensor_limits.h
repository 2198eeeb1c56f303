// What no sensor and no network exceeds.
#pragma once

#include <cstdint>

namespace eventide {

/// px. Larger coordinates are damage, and not taken for a size.
constexpr int kLargestSensorSide = 4096;

/// px: what coordinates of 16 bits can say. Recordings this large can be read and converted.
constexpr int kLargestRecordedSide = 65536;

/// us: no time is further from zero (36000 years), so that sums of times fit.
constexpr std::int64_t kFarthestUs = std::int64_t{1} << 60;

/// Event windows after its own that a frame may wait for.
constexpr int kMaxLookahead = 2;

}  // namespace eventide
