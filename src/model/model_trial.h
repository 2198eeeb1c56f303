// Whether a network computes numbers at all: weights may be finite each and too large together.
#pragma once

#include "src/model/model_file.h"

#include <string>

namespace eventide {

/// Runs the network for a few made-up event windows on a few pixels. Throws Error(input) naming
/// `file` where a frame or its sigma is not finite, or larger than anything could be.
void try_model(const Model& model, const std::string& file);

}  // namespace eventide
