// Which quality a run has, as people and programs read it.
#pragma once

#include "apps/cli/run/quality/quality_choice.h"

#include <nlohmann/json_fwd.hpp>

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace eventide::app {

/// One change while it ran.
struct QualityChange {
    std::chrono::duration<double> at{0};  ///< since the run began
    QualityLevel from, to;
    NetworkLoad load;  ///< of the level before, as it was measured
};

/// At one moment.
struct QualityState {
    bool chosen = false;      ///< false: fixed, and nothing is changed
    bool taken_over = false;  ///< chosen, but a viewer of the live page has set some of it since
    bool holds = true;        ///< the start's choice, by the profile
    std::string model, precision;
    QualityLevel level;
    double frames_per_second = 0;  ///< of the video, before halvings; 0: one for each event window
    NetworkLoad load;              ///< parts of a core: by the profile, then as measured
    double affordable = 0;         ///< at the start
    double threads = 0;
    std::string budget = "none";
    std::string profile;    ///< its file; empty: not kept
    bool measured = false;  ///< the profile, at this start
    std::uint64_t changes = 0;
    std::vector<QualityChange> newest;  ///< of the changes, oldest first
};

/// "0.75x 15 frames/s, event windows of 5 ms or more"
std::string level_text(const QualityLevel& level, double frames_per_second);
/// "default, bf16, 1x 30 frames/s: 0.31 cores by its profile, of 1.2"
std::string choice_text(const QualityState& state);
/// "quality lowered from ... to ...: encoding took 0.95 of a core, frames 0.4"
std::string change_text(const QualityChange& change, double frames_per_second);

/// `all`: with the list of changes, as run.json has it.
nlohmann::ordered_json quality_json(const QualityState& state, bool all);

}  // namespace eventide::app
