// The presets, written out.
#include "src/simulate/presets.h"

#include "src/core/error.h"
#include "src/core/list_text.h"

namespace eventide {

namespace {

/// Tables 3.1 and equations 3.1 to 3.9 of the thesis: one image per scene, no objects, no pauses.
SceneSettings thesis_scene() {
    SceneSettings s;
    s.background = BackgroundMotion::thesis;
    s.objects_max = 0;
    s.pause_start = 0;
    s.white_lux = {10000, 15000};
    s.black_lux = {450, 850};
    s.tone = {.7, 2.5};
    s.faint_probability = 0;
    s.light_change_probability = 0;
    s.flicker_probability = 0;
    s.target = TargetRule::texture;
    return s;
}

SceneSettings thesis_test_scene() {
    SceneSettings s = thesis_scene();
    s.thesis = {.control_points_max = 15,
                .scale_max = 1,
                .angle_max = 2,
                .displacement_max = .75,
                .duration_s = 7.5};
    return s;
}

/// The thesis' simulator is not public; its threshold is .35, and it has noise and mismatch.
SensorSettings thesis_sensor() {
    SensorSettings s;
    s.threshold = {.35, .35};
    s.off_over_on = {1, 1};
    s.mismatch = {.03, .03};
    s.leak_hz = {.1, .1};
    s.shot_hz = {.1, .1};
    s.hot_share = {0, 0};
    s.dropped = {0, 0};
    s.ideal_photoreceptor = 0;
    s.no_noise = 0;
    s.ideal_readout = 0;
    s.bandwidth_hz = {3000, 3000};
    s.bandwidth_hz_per_lux = {20, 20};
    s.refractory_s = {.0002, .0002};
    s.jitter_s = {.00002, .00002};
    return s;
}

SceneSettings demo_scene() {
    SceneSettings s;
    s.wander.speed = {10, 150};
    s.wander.usual_speed = {60, 60};
    s.wander.usual = 1;
    s.wander.leg_s = {.7, .7};
    s.wander.turn = {.8, .8};
    s.wander.linear_probability = 0;
    s.view_share = {.8, .8};
    s.still_background = 0;
    s.objects_min = s.objects_max = 6;
    s.object_reach = -.3;
    s.object_size = {.3, .55};
    s.object_aspect = {.6, 1};
    s.object_speed = {.7, 2};
    s.object_gain = {.5, 1.6};
    s.edge_softness_px = {0, 1};
    s.pause_step_s = .6;
    s.pause_start = .25;
    s.pause_stay = 0;
    s.object_pauses = 0;
    s.white_lux = {1000, 1000};
    s.dynamic_range = {25, 25};
    s.tone = {1.6, 1.6};
    s.faint_probability = 0;
    s.light_change_probability = 0;
    s.flicker_probability = 0;
    s.object_flicker_probability = 0;
    s.target_mean = {.42, .42};
    s.target_deviation = {.24, .24};
    s.target_white_below_one = 0;
    s.target_gamma = {1.6, 1.6};
    s.exposure_fixed = 1;
    return s;
}

SensorSettings demo_sensor() {
    SensorSettings s = SensorSettings::ideal(.18);
    s.mismatch = {.03, .03};
    s.random_phase = true;
    s.bandwidth_hz = {2000, 2000};
    s.refractory_s = {.0001, .0001};
    s.leak_hz = {.05, .05};
    s.shot_hz = {.1, .1};
    s.no_noise = s.ideal_photoreceptor = s.ideal_readout = 0;
    return s;
}

/// All that differs from sequence to sequence is where things are: light and speed are what an
/// experiment sets.
SceneSettings camera_scene() {
    SceneSettings s = demo_scene();
    s.wander.usual_speed = {100, 100};
    s.wander.leg_s = {.3, .3};
    s.object_size = {.15, .5};
    s.object_speed = {.5, 1.5};
    s.pause_start = 0;
    s.white_lux = {100, 100};
    s.target_mean = {.4, .4};
    s.target_deviation = {.2, .2};
    return s;
}

/// In the order of magnitude of what is published: a bandwidth that grows with the light up to 3
/// kHz (Lichtsteiner et al. 2008), thresholds, leak and noise in the dark (Hu et al. 2021, v2e).
SensorSettings camera_sensor() {
    SensorSettings s = SensorSettings::ideal(.2);
    s.mismatch = {.03, .03};
    s.random_phase = true;
    s.dark_lux = {.02, .02};
    s.bandwidth_hz = {3000, 3000};
    s.bandwidth_hz_per_lux = {20, 20};
    s.refractory_s = {.0003, .0003};
    s.leak_hz = {.1, .1};
    s.leak_mismatch = {.2, .2};
    s.shot_hz = {10, 10};
    s.shot_lux = {5, 5};
    s.shot_return_s = {.009, .009};
    s.shot_mismatch = {.5, .5};
    s.hot_share = {.0002, .0002};
    s.jitter_s = {.00005, .00005};
    s.arbiter_hz_per_pixel = {280, 280};
    s.no_noise = s.ideal_photoreceptor = s.ideal_readout = 0;
    return s;
}

}  // namespace

const std::vector<SimulationPreset>& simulation_presets() {
    static const std::vector<SimulationPreset> kPresets{
        {"thesis_train", "affine motion of one image, as in the thesis' training set",
         thesis_scene(), thesis_sensor()},
        {"thesis_test", "affine motion of one image, as in the thesis' test set",
         thesis_test_scene(), thesis_sensor()},
        {"wide", "everything at once: what networks are trained on", SceneSettings{},
         SensorSettings{}},
        {"demo", "a few recognisable objects before a moving background, with a pause",
         demo_scene(), demo_sensor(), 12},
        {"camera", "a noisy camera that moves before photographs, at a set light and speed",
         camera_scene(), camera_sensor()}};
    return kPresets;
}

const SimulationPreset& simulation_preset(std::string_view name) {
    for (const SimulationPreset& preset : simulation_presets())
        if (preset.name == name) return preset;
    throw Error(ErrorKind::usage,
                "no simulated scene is called '" + std::string(name) +
                    "'; there are: " + list_of(simulation_presets(), &SimulationPreset::name));
}

}  // namespace eventide
