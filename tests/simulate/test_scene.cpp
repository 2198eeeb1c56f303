// Motion, pauses, light and the geometry of scenes.
#include "src/core/error.h"
#include "src/simulate/presets.h"
#include "src/simulate/scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace eventide {
namespace {

TEST(ControlCurve, PassesThroughItsPointsStraightOrCurved) {
    Random random{1};
    for (int n = 2; n <= 12; ++n)
        for (const bool cubic : {false, true}) {
            std::vector<double> values(static_cast<std::size_t>(n));
            for (double& v : values) v = random.uniform();
            const ControlCurve curve{values, cubic};
            for (int k = 0; k < n; ++k)
                EXPECT_NEAR(curve.at(double(k) / (n - 1)), values[std::size_t(k)], 1e-9);
        }
}

TEST(ControlCurve, CubicReproducesACubicExactly) {
    // Not-a-knot is the end condition under which a spline gives back any one polynomial.
    const auto polynomial = [](double x) { return 1 - 2 * x + 5 * x * x - 4 * x * x * x; };
    for (const int n : {4, 5, 6, 9, 15}) {
        std::vector<double> values;
        for (int k = 0; k < n; ++k) values.push_back(polynomial(double(k) / (n - 1)));
        const ControlCurve curve{values, true};
        for (double x = 0; x <= 1; x += .01) EXPECT_NEAR(curve.at(x), polynomial(x), 1e-9);
    }
}

TEST(ThesisMotion, BeginsAtRestInItsRangesAndComesBack) {
    const ThesisMotionSettings settings;
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        const auto motion = thesis_motion(settings, Random{seed});
        const Pose first = motion->at(0);
        EXPECT_EQ(first.x, 0);
        EXPECT_EQ(first.angle, 0);
        EXPECT_EQ(first.scale_x, 1);
        for (double t = 0; t < settings.duration_s; t += .1) {
            const Pose pose = motion->at(t), back = motion->at(2 * settings.duration_s - t);
            EXPECT_NEAR(pose.x, back.x, 1e-9);
            // Points lie in the table's ranges; a cubic may swing beyond by some.
            EXPECT_LT(std::abs(pose.x), 2 * 2 * settings.displacement_max);
            EXPECT_LT(std::abs(pose.angle), 2 * settings.angle_max);
            EXPECT_GE(pose.scale_x, .1);
        }
    }
}

TEST(WanderMotion, KeepsItsSpeedOnAverage) {
    WanderSettings settings;
    settings.linear_probability = 1;
    double total = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        const auto motion = wander_motion(settings, 100, 50, {}, {}, Random{seed});
        motion->prepare(60);
        double way = 0;
        for (int i = 0; i < 60000; ++i) {
            const Pose a = motion->at(i * .001), b = motion->at((i + 1) * .001);
            way += std::hypot(b.x - a.x, b.y - a.y);
        }
        total += way / 60 / 40;
    }
    EXPECT_NEAR(total, 100, 4);
}

TEST(WanderMotion, StaysNearHome) {
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        const auto motion = wander_motion({}, 500, 10, {50, 50}, {0, 0, 100, 100}, Random{seed});
        motion->prepare(100);
        int away = 0;
        for (int i = 0; i < 1000; ++i) {
            const Pose p = motion->at(i * .1);
            away += p.x < -100 || p.x > 200 || p.y < -100 || p.y > 200;
        }
        EXPECT_LT(away, 100);
    }
}

TEST(WanderMotion, DoesNotDependOnHowItIsPreparedOrForgotten) {
    const auto once = wander_motion({}, 50, 20, {}, {}, Random{5});
    const auto bit_by_bit = wander_motion({}, 50, 20, {}, {}, Random{5});
    once->prepare(20);
    for (double t = 0; t < 20; t += .01) {
        bit_by_bit->prepare(t);
        EXPECT_EQ(once->at(t).x, bit_by_bit->at(t).x);
        bit_by_bit->forget(t);
    }
}

TEST(PauseClock, PausesWithTheProbabilitiesAskedFor) {
    PauseClock clock{.05, .9, .05, Random{2}};
    clock.prepare(5000);
    int paused = 0, starts = 0, moving = 0;
    bool last = false;
    for (int k = 0; k < 100000; ++k) {
        const bool still = clock.at((k + .75) * .05) == clock.at((k + .25) * .05);
        paused += still;
        starts += still && !last;
        moving += !last;
        last = still;
    }
    EXPECT_NEAR(double(starts) / moving, .05, .003);
    EXPECT_NEAR(double(paused) / starts, 10, .5);  // 1 / (1 - .9) steps
}

TEST(PauseClock, NeverRunsBackwardsOrFasterThanTime) {
    PauseClock clock{.2, .5, .03, Random{3}};
    clock.prepare(100);
    for (double t = 0; t < 99; t += .007) {
        const double way = clock.at(t + .007) - clock.at(t);
        EXPECT_GE(way, 0);
        EXPECT_LE(way, .007 + 1e-12);
    }
}

TEST(LightChanges, StaysInItsDepth) {
    LightChanges light{.7, .1, Random{4}};
    light.prepare(100);
    double low = 0, high = -1;
    for (double t = 0; t < 99; t += .01) {
        low = std::min(low, light.log_gain(t));
        high = std::max(high, light.log_gain(t));
    }
    EXPECT_NEAR(low, -.7, .02);
    EXPECT_NEAR(high, 0, .02);
    EXPECT_LE(high, 0);
}

TEST(Flicker, HasItsFrequencyAndDepth) {
    const Flicker flicker{.depth = .4, .frequency_hz = 100, .phase = 0};
    EXPECT_NEAR(flicker.at(.01), 1.4, 1e-9);
    EXPECT_NEAR(flicker.at(.005), .6, 1e-9);
    EXPECT_EQ(Flicker{}.at(.123), 1);
}

Scene make_scene(const SceneSettings& settings, std::uint64_t seed, int width = 48,
                 int height = 36) {
    static const auto kTextures = procedural_textures(10, 128);
    Scene scene{settings, kTextures, width, height, Random{seed}};
    scene.prepare(10);
    return scene;
}

TEST(Scene, ShowsTheWholeImageAtTheStartOfAThesisScene) {
    GreyImage image(32, 32);
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) image(y, x) = std::uint8_t(y * 8);
    auto textures = std::make_shared<TextureLibrary>();
    textures->add(image);
    Scene scene{simulation_preset("thesis_train").scene, textures, 65, 33, Random{1}};
    scene.prepare(1);
    Array2<float> picture(33, 65);
    scene.render(0, {}, Scene::Show::grey, picture);
    // [-1, 1] are the image's edges and the first and last samples lie on them.
    EXPECT_NEAR(picture(0, 30), 0, .02);
    EXPECT_NEAR(picture(16, 30), .5, .02);
    EXPECT_NEAR(picture(32, 30), 1, .02);
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

/// How far apart two pictures of the same size are at most.
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
