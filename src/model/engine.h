// How a network is run: by the readable reference or by the fast kernels, and with which numbers.
#pragma once

#include "src/core/parallel_for.h"

namespace eventide {

enum class Engine {
    plain,  ///< the reference: readable, slow, allocates
    fast,   ///< tiles over vector kernels; allocation-free once warm
};

/// The numbers products are made of in the fast engine. Sums, states and outputs are always
/// float32.
enum class Precision {
    automatic,  ///< bf16 where the processor has it and it measured faster in this process, else
                ///< f32
    f32,
    bf16,  ///< Error(usage) where neither the processor nor oneDNN offers it
};

struct EngineOptions {
    Engine engine = Engine::fast;
    Precision precision = Precision::automatic;
    ParallelFor parallel_for = sequential_for;
    /// Leave out tiles in whose reach nothing happened. The results are the same bit for bit; off
    /// only for tests and measurements.
    bool skip_quiet = true;
};

}  // namespace eventide
