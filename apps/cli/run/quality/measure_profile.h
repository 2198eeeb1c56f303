// A network's cost on this processor, in a second or two.
#pragma once

#include "apps/cli/run/quality/quality_profile.h"
#include "src/model/engine.h"
#include "src/model/model_file.h"

#include <chrono>
#include <functional>

namespace eventide::app {

struct MeasureSettings {
    Kernels kernels = Kernels::automatic;
    /// About how long it may take; each stage is run once to warm up and once at least to measure.
    std::chrono::duration<double> time{2};
    std::function<bool()> give_up = {};  ///< asked between repetitions: true throws Error (failed)
};

/// Who the figures are of: this processor, this program, this model and sensor.
ProfileKey profile_key(const std::string& name, const Model& model, int width, int height,
                       Kernels kernels);

/// In float32 and, where the processor has it, bf16, on one thread: the stages of eventide bench
/// --stages, with evenly scattered events in place of a scene. Throws what Encoder and Renderer
/// throw.
QualityProfile measure_profile(const ProfileKey& key, const Model& model,
                               const MeasureSettings& settings);

}  // namespace eventide::app
