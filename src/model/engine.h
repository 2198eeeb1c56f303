// How a network is run: by plain code or by the fast kernels, and with what.
#pragma once

#include "src/core/instructions.h"
#include "src/core/parallel_for.h"

#include <eventide/arithmetic.h>

namespace eventide {

enum class Engine {
    plain,  ///< readable, slow, allocates: judges the other
    fast,   ///< tiles over vector kernels; allocation-free once warm
};

struct EngineOptions {
    Engine engine = Engine::fast;
    Precision precision = Precision::automatic;
    Kernels kernels = Kernels::automatic;
    /// The most that our own kernels may use: for comparisons. oneDNN has ONEDNN_MAX_CPU_ISA.
    Instructions instructions = Instructions::best;
    /// Products of bf16 numbers on any processor, slowly, whatever `precision` says: for judging
    /// bf16 without a processor that has it.
    bool emulate_bf16 = false;
    ParallelFor parallel_for = sequential_for;
    /// 1, 2 or 4 networks see the scene as it is and mirrored, each with a memory of its own, and
    /// frames are the mean of theirs: that much more time and memory for a smaller error.
    int self_ensemble = 1;
    /// Leave out tiles in whose reach nothing happened. The results are the same bit for bit; off
    /// only for tests and measurements.
    bool skip_quiet = true;
    /// When a part of a frame counts as still and is copied from one rendered before: its codes are
    /// all within `still_codes` of those it was rendered from, and its place in the event window no
    /// further than `still_time` windows (0 to 1) from the one then. 0 and 0: only where nothing
    /// changed, so that frames are the same bit for bit.
    double still_codes = 0, still_time = 0;
};

}  // namespace eventide
