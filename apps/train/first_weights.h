// The weights that a run begins with, and which of them learn.
#pragma once

#include "apps/train/options.h"
#include "apps/train/training_log.h"

#include <string>
#include <vector>

namespace eventide {

/// Drawn by the seed, or those of options.initial as far as they fit; `say` is told which did not.
Parameters first_weights(const TrainOptions& options, torch::Device device, const LogSink& say);

/// Those whose names begin so, of none all. What is not named stays as it is, and no gradient is
/// computed for it. Throws Error(usage) for a beginning that no name has.
void choose_what_learns(const std::vector<std::string>& prefixes, Parameters& parameters);

}  // namespace eventide
