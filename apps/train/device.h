// Where training computes, and in what numbers.
#pragma once

#include "apps/train/options.h"
#include "apps/train/torch.h"

namespace eventide {

/// Throws Error(usage) for what is no device, Error(device) for one that is not there.
torch::Device device_of(const TrainOptions& options);

/// bfloat16 where the processor has instructions for it (or on a GPU), else float32; or what the
/// option says. Throws Error(usage).
torch::ScalarType arithmetic_type(const TrainOptions& options);

/// Processor time of the whole process, simulation included.
double cpu_seconds();

}  // namespace eventide
