// Adam (Kingma and Ba 2015) with clipped gradients, and a running mean of the weights.
#pragma once

#include "apps/train/network/parameters.h"

#include <cstdint>

namespace eventide {

struct OptimiserSettings {
    double beta1 = 0.9, beta2 = 0.99, epsilon = 1e-8;
    double clip = 1;           ///< largest norm of the whole gradient
    double ema_decay = 0.999;  ///< of the running mean; shorter while few steps are done
};

/// All of its state is public, because a checkpoint is made of it.
struct Optimiser {
    OptimiserSettings settings;
    Parameters parameters;             ///< float32 leaves
    Parameters moment1, moment2, ema;  ///< same names and shapes
    std::int64_t steps = 0;

    Optimiser(const OptimiserSettings& settings, Parameters parameters);

    /// One step down `gradients` (same names). Leaves everything as it was where the gradient is
    /// not finite. Returns the gradient's norm before clipping.
    double step(const Parameters& gradients, double learning_rate);
};

}  // namespace eventide
