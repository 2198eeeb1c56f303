// The smallest network there is, for fuzzing: corpus/model/tiny is random_model(tiny_network(), 1),
// corpus/state/begin its state for a sensor of 8 x 8.
#pragma once

#include "src/model/model_file.h"

namespace eventide {

inline ModelConfig tiny_network() {
    ModelConfig config;
    config.bins = 1;
    config.widths = {1};
    config.recurrent = {1};
    config.res_blocks = 1;
    config.latent = 1;
    config.unfold = 1;
    config.mlp = {1};
    return config;
}

}  // namespace eventide
