// "sim:SCENE?seed=1&size=346x260": what such a source says.
#pragma once

#include "src/simulate/sim_recording.h"

#include <string>
#include <string_view>

namespace eventide {

struct SimulatedSourceSettings {
    std::string scene = "demo";  ///< a name in simulation_presets()
    SimRecordingSettings recording;
    double speed = 1;      ///< sensor time over host time; 0: as fast as possible, and not live
    std::string textures;  ///< folder of images or pack of textures; empty: procedural
};

/// What its name begins with.
inline constexpr std::string_view kSimulatedScheme = "sim:";

bool names_simulation(std::string_view source);

/// sim:SCENE?KEY=VALUE&..., all optional:
///   seed=N         number of the scene; the preset's own where not given
///   size=WxH       px, 240x180
///   images=N       reference images per second, 25; 0 for none
///   seconds=N      length, from 0.001 up; endless in real time, 4 with speed=max
///   speed=N|max    0.001 to 1000, 1 is real time; max is not live: nothing is lost, and it ends
///   textures=PATH  folder of images or pack of textures
/// Throws Error (usage) naming the key, what it expects and what was found.
SimulatedSourceSettings parse_simulated_name(std::string_view source);

}  // namespace eventide
