// The geometry, light and layers of scenes.
#include "src/core/error.h"
#include "src/simulate/presets.h"
#include "src/simulate/scene/scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace eventide {
namespace {

Scene make_scene(const SceneSettings& settings, std::uint64_t seed, int width = 48,
                 int height = 36) {
    static const auto kTextures = procedural_textures(10, 128);
    Scene scene{settings, kTextures, width, height, Random{seed}};
    scene.prepare(10);
    return scene;
}

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

/// How far apart two images of the same size are at most.
float difference(const Array2<float>& a, const Array2<float>& b) {
    float largest = 0;
    for (std::size_t i = 0; i < a.values().size(); ++i)
        largest = std::max(largest, std::abs(a.values()[i] - b.values()[i]));
    return largest;
}

TEST(Scene, StepsSoShortThatNothingMovesFurtherThanAskedFor) {
    SceneSettings settings;
    settings.objects_min = 1;
    settings.objects_max = 1;
    settings.wander.speed = settings.wander.usual_speed = {200, 200};
    settings.object_speed = {1, 1};
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const Scene scene = make_scene(settings, seed);
        double t = 0;
        int steps = 0;
        for (; t < 1; ++steps) {
            const double step = scene.step(t);
            EXPECT_GE(step, settings.step_s.low);
            EXPECT_LE(step, settings.step_s.high);
            t += step;
        }
        EXPECT_LT(steps, 6000);
    }
    settings.wander.speed = settings.wander.usual_speed = {0, 0};
    settings.object_speed = {0, 0};
    settings.wander.speed.high = 0;
    settings.flicker_probability = settings.object_flicker_probability = 0;
    EXPECT_EQ(make_scene(settings, 1).step(.5), settings.step_s.high);
}

TEST(Scene, StandsStillInPauses) {
    SceneSettings settings;
    settings.pause_start = 1;
    settings.pause_stay = 1;
    settings.light_change_probability = settings.flicker_probability = 0;
    settings.object_flicker_probability = 0;
    settings.wander.speed = {100, 100};
    const Scene scene = make_scene(settings, 6);
    Array2<float> first(36, 48), later(36, 48);
    scene.render(.06, {}, Scene::Show::light, first);
    scene.render(9.9, {}, Scene::Show::light, later);
    EXPECT_EQ(difference(first, later), 0);
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

/// Light of what is fixed to the background, and of nothing else that moves by itself.
SceneSettings pinned_scenes() {
    SceneSettings settings;
    settings.objects_max = 0;
    settings.pinned_max = 12;
    settings.object_size = {.3, .3};
    settings.faint_probability = settings.light_change_probability = 0;
    settings.flicker_probability = settings.object_flicker_probability = 0;
    return settings;
}

TEST(Scene, PinnedThingsStandStillWithTheBackground) {
    SceneSettings settings = pinned_scenes();
    settings.still_background = 1;
    int seen = 0;
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        Array2<float> first(36, 48), later(36, 48), bare(36, 48);
        const Scene scene = make_scene(settings, seed);
        scene.render(.06, {}, Scene::Show::light, first);
        scene.render(9.9, {}, Scene::Show::light, later);
        EXPECT_EQ(difference(first, later), 0);
        EXPECT_EQ(scene.step(.06), settings.step_s.high) << "nothing moves";
        settings.pinned_max = 0;
        make_scene(settings, seed).render(.06, {}, Scene::Show::light, bare);
        settings.pinned_max = 12;
        seen += difference(first, bare) > 0;
    }
    EXPECT_GT(seen, 5);
}

TEST(Scene, HasFromNoneToTheMostPinnedThings) {
    SceneSettings settings = pinned_scenes();
    settings.still_background = 1;
    settings.object_size = settings.object_aspect = {1.2, 1.2};
    int seen = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        Array2<float> light(36, 48), bare(36, 48);
        settings.pinned_max = 1;
        make_scene(settings, seed).render(0, {}, Scene::Show::light, light);
        settings.pinned_max = 0;
        make_scene(settings, seed).render(0, {}, Scene::Show::light, bare);
        seen += difference(light, bare) > 0;
    }
    EXPECT_GT(seen, 15);
    EXPECT_LT(seen, 40) << "half of them have none";
}

TEST(Scene, PinnedThingsGoWhereTheBackgroundGoes) {
    SceneSettings settings = pinned_scenes();
    settings.still_background = 0;
    settings.wander.speed = settings.wander.usual_speed = {20, 20};
    settings.wander.spin_share = settings.wander.zoom_share = {0, 0};
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
        const Scene scene = make_scene(settings, seed);
        Array2<float> before(36, 48), after(36, 48);
        scene.render(1, {}, Scene::Show::light, before);
        scene.render(1.2, {}, Scene::Show::light, after);
        // All of the image is the one before, moved by one displacement.
        double best = 1e9;
        for (double dy = -5; dy <= 5; dy += .25)
            for (double dx = -5; dx <= 5; dx += .25) {
                Array2<float> moved(26, 38), same(26, 38);
                scene.render(1, Affine::translation(5 + dx, 5 + dy), Scene::Show::light, moved);
                for (int y = 0; y < 26; ++y)
                    for (int x = 0; x < 38; ++x) same(y, x) = after(y + 5, x + 5);
                double total = 0;
                for (std::size_t i = 0; i < same.values().size(); ++i)
                    total += std::abs(double(same.values()[i] - moved.values()[i]));
                best = std::min(best, total / double(same.values().size()));
            }
        EXPECT_LT(best, .02 * scene.white_lux());
    }
}

/// Mean change of grey in 10 x 10 px around a place.
double change_at(const Scene& scene, double x, double y) {
    Array2<float> before(10, 10), after(10, 10);
    const Affine place = Affine::translation(x - 4.5, y - 4.5);
    scene.render(1, place, Scene::Show::grey, before);
    scene.render(1.1, place, Scene::Show::grey, after);
    double total = 0;
    for (std::size_t i = 0; i < before.values().size(); ++i)
        total += std::abs(double(before.values()[i] - after.values()[i]));
    return total / double(before.values().size());
}

TEST(Scene, SpinsAndZoomsAboutTheMiddleOfTheView) {
    SceneSettings settings;
    settings.objects_max = 0;
    settings.still_background = settings.pause_start = settings.faint_probability = 0;
    settings.view_share = {.3, .3};
    settings.wander.speed = settings.wander.usual_speed = {1, 1};
    for (const auto& [spin, zoom] : {std::pair{60., 0.}, {0., 60.}}) {
        settings.wander.spin_share = {spin, spin};
        settings.wander.zoom_share = {zoom, zoom};
        double middle = 0, corners = 0;
        for (std::uint64_t seed = 0; seed < 16; ++seed) {
            const Scene scene = make_scene(settings, seed, 121, 91);
            middle += change_at(scene, 60, 45);
            for (const double x : {0., 120.})
                for (const double y : {0., 90.}) corners += change_at(scene, x, y) / 4;
        }
        EXPECT_GT(corners, 4 * middle) << spin << " " << zoom;
    }
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
}  // namespace eventide
