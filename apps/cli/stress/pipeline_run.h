// One run of the whole pipeline over a made stream, and what is to be said about it.
#pragma once

#include "apps/cli/stress/made_stream.h"
#include "apps/cli/stress/watched_stages.h"
#include "pipeline/pipeline.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace eventide::stress {

struct PipelineRunSettings {
    int width = 32, height = 24;  ///< px, of the sensor
    std::string window = "50ms";  ///< as --window
    std::string fps = "30";       ///< as --fps; "frame": one for each event window
    int lookahead = 0;
    FrameSize size{};
    bool threaded = false;             ///< without double precision
    std::optional<Sampling> sampling;  ///< empty: without double precision
    EngineOptions engine;
    std::optional<TensorFile> state;  ///< to begin with
    std::function<bool()> stopping;   ///< ends the run early; may be empty
    /// Sees every frame. Render thread.
    std::function<void(const Frame&)> on_frame;
    /// Sees every grid before the network does, and may change it. Encode thread.
    std::function<void(VoxelGrid&)> on_grid;
};

struct PipelineOutcome {
    Snapshot counters;
    Distance codes, frames;    ///< against double precision
    double largest_state = 0;  ///< of recurrent levels, at the windows looked at
    std::uint64_t bits = 0;    ///< of all frames and the times between them: equal where all are
    Frame last;                ///< the newest frame
    TensorFile state;          ///< at the end
    std::string error;         ///< what the run ended with; empty: nothing
    std::string engine;        ///< which kernels and numbers ran
};

/// What a run holds at once: a single thread has one grid and one latent map at work.
PipelineBuffers run_buffers(bool threaded);

/// Errors of the run are in the outcome; those of settings are thrown.
PipelineOutcome run_pipeline(const Model& model, Source& source,
                             const PipelineRunSettings& settings);
PipelineOutcome run_pipeline(const Model& model, MakeEvents events,
                             const PipelineRunSettings& settings);

/// "0.0123", "1.2e-06": for tables.
std::string short_number(double value);
std::string counted(std::uint64_t n, std::string_view what);

}  // namespace eventide::stress
