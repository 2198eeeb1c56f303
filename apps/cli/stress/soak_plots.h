// What a soak watched, drawn over its time.
#pragma once

#include "apps/cli/stress/soak.h"
#include "apps/evaluate/plot.h"

#include <vector>

namespace eventide::app {

/// Memory, latency and states; without samples their names alone.
std::vector<Plot> soak_plots(const std::vector<stress::SoakSample>& samples);

}  // namespace eventide::app
