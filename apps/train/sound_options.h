// Options of a run that fit each other.
#pragma once

#include "apps/train/options.h"

namespace eventide {

/// The options, once what no single one can say of itself holds. Throws Error (usage): what a run
/// cannot be made of, and what it would be told only at its end.
const TrainOptions& sound(const TrainOptions& options);

/// In `--out`.
inline constexpr const char* kCheckpoint = "checkpoint.safetensors";
inline constexpr const char* kBest = "best.safetensors";

}  // namespace eventide
