// Conditions as ranges of one value.
#include "src/simulate/conditions.h"

#include "src/core/error.h"

#include <algorithm>

namespace eventide {
namespace {

void set_light(SceneSettings& scene, double lux) {
    const double share = lux / scene.white_lux.high;
    scene.white_lux = {lux, lux};
    scene.black_lux = {share * scene.black_lux.low, share * scene.black_lux.high};
}

void set_speed(SceneSettings& scene, double speed) {
    WanderSettings& wander = scene.wander;
    wander.usual_speed = {speed, speed};
    wander.usual = 1;
    scene.still_background = 0;
    // What the speeds of objects are held within.
    wander.speed = {std::min(wander.speed.low, speed), std::max(wander.speed.high, speed)};
}

}  // namespace

SimulationPreset under(const SceneConditions& conditions, SimulationPreset preset) {
    if (conditions.lux) set_light(preset.scene, *conditions.lux);
    if (conditions.speed) {
        if (preset.scene.background == BackgroundMotion::thesis)
            throw Error(ErrorKind::usage, "simulated scene '" + preset.name +
                                              "': its image follows paths of a given duration; "
                                              "expected no speed");
        set_speed(preset.scene, *conditions.speed);
    }
    if (conditions.lamp) preset.scene.lamp = *conditions.lamp;
    return preset;
}

}  // namespace eventide
