// How hard a simulated scene is: its light, its speed, a lamp in view.
#pragma once

#include "src/simulate/presets.h"

#include <optional>

namespace eventide {

/// What is not given stays as the scene draws it.
struct SceneConditions {
    std::optional<double> lux{};    ///< illuminance on the chip where the scene is white, > 0
    std::optional<double> speed{};  ///< px/s, of the camera's own motion and of what moves, > 0
    std::optional<double> lamp{};   ///< light of a lamp in view over that of white, > 0
};

/// The preset under these conditions. Throws Error (usage) for a speed where the scene's motion
/// has none (the thesis' paths).
SimulationPreset under(const SceneConditions& conditions, SimulationPreset preset);

}  // namespace eventide
