// How a network is run: by the readable reference or by the fast kernels, and with which numbers.
#pragma once

#include "src/core/parallel_for.h"

#include <eventide/arithmetic.h>

namespace eventide {

enum class Engine {
    plain,  ///< the reference: readable, slow, allocates
    fast,   ///< tiles over vector kernels; allocation-free once warm
};

struct EngineOptions {
    Engine engine = Engine::fast;
    Precision precision = Precision::automatic;
    Kernels kernels = Kernels::automatic;
    ParallelFor parallel_for = sequential_for;
    /// Leave out tiles in whose reach nothing happened. The results are the same bit for bit; off
    /// only for tests and measurements.
    bool skip_quiet = true;
};

}  // namespace eventide
