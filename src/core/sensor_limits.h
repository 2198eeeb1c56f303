// What no sensor exceeds.
#pragma once

namespace eventide {

/// px. Larger coordinates are damage, and not taken for a size.
constexpr int kLargestSensorSide = 4096;

}  // namespace eventide
