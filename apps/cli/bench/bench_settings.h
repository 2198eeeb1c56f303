// What `eventide bench` measures, and how.
#pragma once

#include "apps/bench/stages.h"
#include "apps/cli/bench/pipeline_bench.h"
#include "src/core/sensor_limits.h"

#include <string>
#include <vector>

namespace eventide::app {

/// Every model and precision on every size.
struct BenchSettings {
    std::string scene = "demo";
    std::vector<std::string> sizes{"240x180", "346x260", "640x480"}, models{"default"},
        precisions{"auto"};
    double seconds = 2;  ///< of each simulated recording
    double scale = 1;    ///< of the frames, times the sensor's size
    int lookahead = kMaxLookahead;
    int threads = 0;                             ///< of the pipeline, as in eventide run
    int repetitions = bench::kLeastRepetitions;  ///< of stages
    Engine engine = Engine::fast;
    Instructions instructions = Instructions::best;  ///< the most that may be used
    double still_codes = 0.02, still_time = 1;       ///< EngineOptions, of activity
    std::string lpips;  ///< weights; empty: frames are not judged by it

    bench::StageSettings stage(const Size& sensor, Precision precision) const {
        return {.width = sensor.width,
                .height = sensor.height,
                .scale = scale,
                .lookahead = lookahead,
                .engine = {.engine = engine,
                           .precision = precision,
                           .instructions = instructions,
                           .still_codes = still_codes,
                           .still_time = still_time},
                .repetitions = repetitions};
    }
    PipelineBenchSettings pipeline(const std::string& model, Precision precision) const {
        PipelineBenchSettings settings;
        settings.model = model;
        settings.precision = precision;
        settings.engine = engine;
        settings.instructions = instructions;
        settings.threads = threads;
        settings.scale = scale;
        settings.lookahead = lookahead;
        return settings;
    }
};

}  // namespace eventide::app
