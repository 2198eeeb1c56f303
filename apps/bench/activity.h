// What an event window and a frame of it cost when only a part of the scene moves.
#pragma once

#include "apps/bench/stages.h"

namespace eventide::bench {

/// How far frames made with skipping differ from frames made without it.
struct FrameError {
    double most = 0, rms = 0;  ///< of intensity
};

struct ActivityRow {
    std::string model, engine;
    int width = 0, height = 0;
    double moving = 0;   ///< share of the sensor's area that has events: a square in its middle
    double changed = 0;  ///< share of the latent map's tiles that a window changes
    Spread encode_ms;    ///< processor time, one event window
    bool is_encode_exact = true;  ///< whether codes are those without skipping, bit for bit
    Spread render_ms;             ///< a frame at the same place of each window
    FrameError error;             ///< of these
    Spread anywhere_ms;   ///< frames at changing places, with StageSettings::engine.still_time
    FrameError anywhere;  ///< of these
};

/// One row for each share of `moving`. `windows` as in measure_stages().
std::vector<ActivityRow> measure_activity(const std::string& name, const Model& model,
                                          const std::vector<SceneWindow>& windows,
                                          const StageSettings& settings,
                                          const std::vector<double>& moving);

}  // namespace eventide::bench
