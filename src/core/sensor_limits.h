// What no sensor and no network exceeds.
#pragma once

namespace eventide {

/// px. Larger coordinates are damage, and not taken for a size.
constexpr int kLargestSensorSide = 4096;

/// Event windows after its own that a frame may wait for.
constexpr int kMaxLookahead = 2;

}  // namespace eventide
