// Named scenes and sensors.
#pragma once

#include "src/simulate/scene/scene_settings.h"
#include "src/simulate/sensor/sensor_settings.h"

#include <string>
#include <string_view>
#include <vector>

namespace eventide {

struct SimulationPreset {
    std::string name;
    std::string what;  ///< one line for --help
    SceneSettings scene;
    SensorSettings sensor;
    std::uint64_t seed = 1;  ///< the one to show
};

/// thesis_train, thesis_test: the thesis' scenes before a sensor of its threshold, .35.
/// wide: what our networks are trained on.
/// demo: few, slow, bright, recognisable objects; a clean sensor.
/// camera: what an experiment on light, speed and glare begins with (conditions.h).
const std::vector<SimulationPreset>& simulation_presets();

/// Throws Error (usage), naming the known ones.
const SimulationPreset& simulation_preset(std::string_view name);

}  // namespace eventide
