// The stages of a network alone: one after the other, nothing beside them, everything moving.
#pragma once

#include "apps/bench/peaks.h"
#include "apps/bench/scene_windows.h"
#include "apps/bench/timing.h"
#include "src/model/engine.h"
#include "src/model/model_file.h"

#include <string>
#include <vector>

namespace eventide::bench {

constexpr int kLeastRepetitions = 30;

struct StageSettings {
    int width = 0, height = 0;  ///< px, of the sensor
    double scale = 1;           ///< frames are so many times its size
    int lookahead = 0;
    EngineOptions engine;  ///< without skipping: every tile is computed, whatever `skip_quiet` is
    int repetitions = kLeastRepetitions;
};

/// One stage: its time, the useful products in it, and what of the peak they come to.
struct Stage {
    Timing time;
    double products = 0;

    double gflops() const { return 2e-6 * products / time.cpu_ms.median; }
    double share(double peak_gflops) const { return peak_gflops > 0 ? gflops() / peak_gflops : 0; }
};

struct StageRow {
    std::string model, engine;
    int width = 0, height = 0, threads = 1;
    bool bf16 = false;       ///< whether its products are
    Spread bin_mev_s;        ///< million events a second of processor time
    Stage encode;            ///< one event window
    Stage fresh;             ///< a frame of an event window that none was rendered of before
    Stage again;             ///< another frame of the same window
    double peak_gflops = 0;  ///< of the numbers it multiplies, of as many threads
};

/// `windows`: of a sensor of this size, at least one. Throws what Encoder and Renderer throw.
StageRow measure_stages(const std::string& name, const Model& model,
                        const std::vector<SceneWindow>& windows, const StageSettings& settings,
                        const Peaks& peaks);

}  // namespace eventide::bench
