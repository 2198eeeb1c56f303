// What a run takes in memory, said before it is taken and when there is too little.
#pragma once

#include "pipeline/pipeline.h"
#include "src/core/error.h"
#include "src/model/engine.h"
#include "src/model/model_config.h"
#include "src/model/render/renderer.h"

#include <cstdint>
#include <string>

namespace eventide::app {

/// Bytes of the largest maps alone; the network takes this much at least. Latent maps, and what is
/// kept of them for rendering, count as bf16 where `precision` allows it.
std::uint64_t network_bytes(const ModelConfig& config, const SensorInfo& sensor,
                            Precision precision);

/// Bytes of the event windows and latent maps on their way, without frames; at least, as above.
std::uint64_t buffer_bytes(const ModelConfig& config, const SensorInfo& sensor,
                           const PipelineBuffers& buffers, Precision precision);

/// Bytes of a frame as it is rendered, or of the part of it that is wanted.
std::uint64_t frame_bytes(const RenderRequest& request, const SensorInfo& sensor);

/// An Error (failed) that says what wanted how much, and for which sensor.
Error out_of_memory(const std::string& what, std::uint64_t bytes, const SensorInfo& sensor);

}  // namespace eventide::app
