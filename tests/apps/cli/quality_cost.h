// What a network costs in the tests of quality that follows the load.
#pragma once

#include "apps/cli/run/quality/quality_control.h"

#include <chrono>

namespace eventide::app {

using Seconds = std::chrono::duration<double>;

/// 20 event windows and 40 frames a second; on one thread, by the profile, 0.2 for encoding and
/// 0.2 for frames.
inline const PrecisionCost kCost{Precision::f32, "fast", 10, 2, 4, 4, 1};

}  // namespace eventide::app
