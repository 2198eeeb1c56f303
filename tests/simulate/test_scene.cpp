// Light and layers of scenes.
#include "src/core/error.h"
#include "src/simulate/presets.h"
#include "tests/simulate/scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace eventide::test {
namespace {

TEST(Scene, LightFollowsTheThesisToneCurve) {
    SceneSettings settings = simulation_preset("thesis_train").scene;
    settings.white_lux = {12000, 12000};
    settings.black_lux = {600, 600};
    settings.tone = {1.5, 1.5};
    const Scene scene = make_scene(settings, 3);
    Array2<float> grey(36, 48), light(36, 48);
    scene.render(.4, {}, Scene::Show::grey, grey);
    scene.render(.4, {}, Scene::Show::light, light);
    for (std::size_t i = 0; i < grey.values().size(); ++i) {
        const double x = double(grey.values()[i]);
        const double expected = 600 + (std::exp(1.5 * x) - 1) / (std::exp(1.5) - 1) * (12000 - 600);
        EXPECT_NEAR(light.values()[i], expected, 1);
    }
}

TEST(Scene, FaintScenesSpanNoMoreThanTheirContrast) {
    SceneSettings settings;
    settings.objects_max = 0;
    settings.faint_probability = 1;
    settings.faint_contrast = {.2, .2};
    settings.dynamic_range = {20, 20};
    settings.tone = {0, 0};  // linear: the light's range is that of the grey values
    double darkest = 1, brightest = 0, widest = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const Scene scene = make_scene(settings, seed);
        Array2<float> light(100, 100);
        scene.render(0, {5, 0, 0, 0, 5, 0}, Scene::Show::light, light);
        const auto [low, high] = std::ranges::minmax(light.values());
        const double span = double(high - low) / (scene.white_lux() * (1 - 1 / 20.));
        EXPECT_LT(span, .205);
        widest = std::max(widest, span);
        darkest = std::min(darkest, double(low) / scene.white_lux());
        brightest = std::max(brightest, double(high) / scene.white_lux());
    }
    EXPECT_GT(widest, .1);
    EXPECT_LT(darkest, .2) << "some of them in the dark ...";
    EXPECT_GT(brightest, .85) << "... and some in the light";
}

TEST(Scene, HasAsManyThingsAsTheMostAllowed) {
    SceneSettings settings;
    settings.objects_min = 0;
    settings.objects_max = 1;
    settings.objects_skew = 1;
    settings.object_size = {2.5, 2.5};
    settings.object_reach = 0;
    settings.still_background = 1;
    settings.pause_start = 0;
    settings.object_pauses = 0;
    settings.wander.speed = settings.wander.usual_speed = {100, 100};
    settings.object_speed = {1, 1};
    settings.flicker_probability = settings.light_change_probability = 0;
    settings.object_flicker_probability = 0;
    int with_one = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed)
        with_one += make_scene(settings, seed).step(.1) < settings.step_s.high;
    EXPECT_GT(with_one, 10) << "half of them";
    EXPECT_LT(with_one, 30);
}

TEST(Scene, LampsOfAllMainsFlicker) {
    SceneSettings settings;
    settings.flicker_probability = 1;
    settings.flicker_depth = {.5, .5};
    std::set<int> frequencies;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        const Scene scene = make_scene(settings, seed);
        for (const int hz : {120, 100, 60, 50}) {  // a lamp of 100 Hz repeats itself at 50, too
            const bool repeats = std::abs(scene.flicker(.0013) - scene.flicker(.0013 + 1. / hz)) +
                                     std::abs(scene.flicker(.004) - scene.flicker(.004 + 1. / hz)) <
                                 1e-6;
            if (!repeats) continue;
            frequencies.insert(hz);
            break;
        }
    }
    EXPECT_EQ(frequencies, (std::set{50, 60, 100, 120}));
}

TEST(Scene, IsDarkestAndBrightestAsTheDynamicRangeSays) {
    SceneSettings settings;
    settings.dynamic_range = {50, 50};
    settings.objects_max = 0;
    settings.faint_probability = 0;
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const Scene scene = make_scene(settings, seed);
        Array2<float> light(100, 100);
        scene.render(0, {5, 0, 0, 0, 5, 0}, Scene::Show::light, light);
        for (const float v : light.values()) {
            EXPECT_LE(v, scene.white_lux() * 1.001);
            EXPECT_GE(v, scene.white_lux() / 50 * .99);
        }
    }
}

TEST(Scene, ObjectsHideWhatIsBehindThem) {
    SceneSettings settings;
    settings.objects_min = settings.objects_max = 1;
    settings.object_size = {.9, .9};
    settings.object_aspect = {1, 1};
    settings.still_background = 1;
    settings.object_gain = {3, 3};
    settings.dynamic_range = {2, 2};  // the object's darkest is brighter than all behind it
    settings.flicker_probability = settings.object_flicker_probability = 0;
    settings.faint_probability = 0;
    settings.wander.speed = settings.wander.usual_speed = {.1, .1};
    const Scene scene = make_scene(settings, 8);
    Array2<float> light(36, 48);
    scene.render(0, {}, Scene::Show::light, light);
    const auto white = float(scene.white_lux());
    const auto bright =
        std::ranges::count_if(light.values(), [&](float v) { return v > 1.45f * white; });
    const auto dark =
        std::ranges::count_if(light.values(), [&](float v) { return v <= 1.01f * white; });
    EXPECT_GT(bright, 80);
    EXPECT_GT(dark, 80);
    EXPECT_GT(double(bright + dark), .8 * 36 * 48);  // little between: edges only
}

TEST(Scene, AFlatThingIsOfOneGrey) {
    SceneSettings settings;
    settings.objects_min = settings.objects_max = 1;
    settings.object_size = {2.5, 2.5};
    settings.object_aspect = {1, 1};
    settings.still_background = 1;
    settings.wander.speed = settings.wander.usual_speed = {.1, .1};
    settings.object_reach = 0;
    const auto of_one_grey = [&](std::uint64_t seed) {
        Array2<float> grey(36, 48);
        make_scene(settings, seed).render(0, {}, Scene::Show::grey, grey);
        std::ptrdiff_t most = 0;
        for (const float v : grey.values())
            most = std::max(most, std::ranges::count_if(grey.values(), [v](float w) {
                                return std::abs(v - w) < .004f;
                            }));
        return double(most) / double(grey.values().size());
    };
    double textured = 0, flat = 0;
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
        settings.object_flat = 0;
        textured += of_one_grey(seed) / 8;
        settings.object_flat = 1;
        flat += of_one_grey(seed) / 8;
    }
    EXPECT_GT(flat, textured + .3);
}

TEST(Scene, RefusesWhatItCannotShow) {
    EXPECT_THROW(Scene({}, nullptr, 10, 10, Random{1}), Error);
    EXPECT_THROW(Scene({}, std::make_shared<TextureLibrary>(), 10, 10, Random{1}), Error);
    EXPECT_THROW(Scene({}, procedural_textures(1, 16), 1, 10, Random{1}), Error);
}

TEST(Presets, HaveTheThesisTableAndRefuseUnknownNames) {
    const SceneSettings& train = simulation_preset("thesis_train").scene;
    EXPECT_EQ(train.thesis.control_points_max, 10);
    EXPECT_EQ(train.thesis.scale_max, .7);
    EXPECT_EQ(train.thesis.angle_max, 1.7);
    EXPECT_EQ(train.thesis.displacement_max, .6);
    const SceneSettings& test = simulation_preset("thesis_test").scene;
    EXPECT_EQ(test.thesis.control_points_max, 15);
    EXPECT_EQ(test.thesis.scale_max, 1);
    EXPECT_EQ(test.thesis.angle_max, 2);
    EXPECT_EQ(test.thesis.displacement_max, .75);
    EXPECT_EQ(simulation_preset("thesis_test").sensor.threshold.low, .35);
    EXPECT_THROW(simulation_preset("nothing"), Error);
}

}  // namespace
}  // namespace eventide::test
