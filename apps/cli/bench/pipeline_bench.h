// The whole pipeline on a recording in memory: what it takes, and how far its frames are from the
// truth.
#pragma once

#include "apps/cli/bench/packets_in_memory.h"
#include "apps/cli/signals.h"
#include "apps/evaluate/scores.h"
#include "pipeline/counters.h"
#include "pipeline/frame_clock.h"
#include "src/model/engine.h"

#include <optional>
#include <string>

namespace eventide::app {

struct PipelineBenchSettings {
    std::string model = "default";
    Precision precision = Precision::automatic;
    Kernels kernels = Kernels::automatic;
    Instructions instructions = Instructions::best;
    Engine engine = Engine::fast;
    int threads = 0;               ///< as in eventide run
    double scale = 1;              ///< of the frames, times the sensor's size
    int lookahead = 0;             ///< as in eventide run
    std::string window = "aps";    ///< as in eventide run
    FrameRate rate{};              ///< none: a frame at the end of each event window
    double speed = 0;              ///< sensor time over host time; 0: as fast as possible
    const Lpips* lpips = nullptr;  ///< judges frames too, where it is given
};

struct PipelineBench {
    std::string model, engine;
    Size sensor;
    Snapshot counters;
    double seconds = 0;    ///< by the clock
    SequenceScores error;  ///< of frames that have an image of their time; no frames: none had
};

/// Stops early when a signal comes.
PipelineBench measure_pipeline(const std::shared_ptr<const RecordedPackets>& data,
                               const PipelineBenchSettings& settings, Signals& signals);

double milliseconds(std::chrono::nanoseconds duration);

}  // namespace eventide::app
