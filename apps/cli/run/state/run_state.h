// What the networks of a run remember, as one file.
#pragma once

#include "apps/cli/run/colour.h"
#include "apps/cli/run/loaded_model.h"
#include "src/nn/safetensors.h"

#include <string>

namespace eventide::app {

/// Encoder::state(); with colours the colour filter beside it, and each colour's tensors under its
/// name ("red.h.0"). `colour` may be null.
TensorFile state_of(const Network& network, const ColourNetworks* colour);

/// `file` is what `state` was read from. Throws Error (input) naming the file and what differs,
/// where it is of another model or sensor, or with colours where there are none, and the other way
/// round.
void restore_state(TensorFile state, const std::string& file, Network& network,
                   ColourNetworks* colour);

}  // namespace eventide::app
