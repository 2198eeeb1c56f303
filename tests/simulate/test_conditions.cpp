// Light, speed and a lamp as an experiment sets them.
#include "src/core/error.h"
#include "src/simulate/conditions.h"
#include "src/simulate/scene/scene.h"
#include "src/simulate/scene/textures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace eventide {
namespace {

constexpr int kWidth = 64, kHeight = 48;

Scene scene_under(const SceneConditions& conditions, std::uint64_t seed) {
    static const auto kTextures = procedural_textures(10, 128);
    Scene scene{under(conditions, simulation_preset("camera")).scene, kTextures, kWidth, kHeight,
                Random{seed}};
    scene.prepare(2);
    return scene;
}

Array2<float> light_of(const Scene& scene) {
    Array2<float> light(kHeight, kWidth);
    scene.render(.5, {}, Scene::Show::light, light);
    return light;
}

/// Half pixels that something moves by in a second, on average over half a second.
double pace_of(const Scene& scene) {
    double sum = 0;
    for (int i = 0; i < 100; ++i) sum += 1 / scene.step(.005 * i);
    return sum / 100;
}

TEST(SceneConditions, LightIsThatOfWhiteAndKeepsItsProportions) {
    for (std::uint64_t seed = 1; seed < 6; ++seed) {
        const Scene dim = scene_under({.lux = 2}, seed), bright = scene_under({.lux = 2000}, seed);
        EXPECT_NEAR(dim.white_lux(), 2, 1e-9);
        const Array2<float> a = light_of(dim), b = light_of(bright);
        for (std::size_t i = 0; i < a.values().size(); ++i)
            ASSERT_NEAR(1000 * a.values()[i], b.values()[i], .01 * b.values()[i]);
    }
}

TEST(SceneConditions, BlackInLuxFollowsTheLight) {
    const SceneSettings scene = under({.lux = 15}, simulation_preset("thesis_test")).scene;
    EXPECT_NEAR(scene.white_lux.low, 15, 1e-9);
    EXPECT_NEAR(scene.black_lux.low, .45, 1e-9);
    EXPECT_NEAR(scene.black_lux.high, .85, 1e-9);
}

TEST(SceneConditions, EverythingMovesAsManyTimesAsFast) {
    for (std::uint64_t seed = 1; seed < 6; ++seed) {
        const double slow = pace_of(scene_under({.speed = 40}, seed));
        const double fast = pace_of(scene_under({.speed = 400}, seed));
        EXPECT_NEAR(fast / slow, 10, 3) << seed;
    }
}

TEST(SceneConditions, ACameraOfWhichASpeedIsAskedForMoves) {
    SceneSettings scene = under({.speed = 200}, simulation_preset("wide")).scene;
    scene.objects_max = scene.pinned_max = 0;
    scene.pause_start = scene.flicker_probability = scene.light_change_probability = 0;
    for (std::uint64_t seed = 1; seed < 40; ++seed) {
        Scene moving{scene, procedural_textures(4, 64), kWidth, kHeight, Random{seed}};
        moving.prepare(2);
        EXPECT_GT(pace_of(moving), 1.01 / scene.step_s.high) << seed;
    }
}

TEST(SceneConditions, ALampIsBeforeTheSameScene) {
    for (std::uint64_t seed = 1; seed < 6; ++seed) {
        const Array2<float> plain = light_of(scene_under({}, seed));
        const Array2<float> lit = light_of(scene_under({.lamp = 1000}, seed));
        const double white = simulation_preset("camera").scene.white_lux.high;
        EXPECT_NEAR(*std::ranges::max_element(lit.values()), 1000 * white, 10 * white);
        // A disc of some 6 px, whose edge is soft.
        std::size_t same = 0;
        for (std::size_t i = 0; i < plain.values().size(); ++i)
            same += plain.values()[i] == lit.values()[i] ? 1 : 0;
        EXPECT_GE(same, plain.values().size() - 120);
        EXPECT_LE(same, plain.values().size() - 10);
    }
}

/// Share of the first two seconds of eight scenes in which the lamp is seen.
double seen_at(double speed) {
    const double white = simulation_preset("camera").scene.white_lux.high;
    int seen = 0;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
        const Scene scene = scene_under({.speed = speed, .lamp = 1000}, seed);
        for (int i = 0; i < 100; ++i) {
            Array2<float> light(kHeight, kWidth);
            scene.render(.02 * i, {}, Scene::Show::light, light);
            seen += *std::ranges::max_element(light.values()) > 100 * white;
        }
    }
    return seen / 800.;
}

TEST(SceneConditions, ALampStaysInViewHoweverFastItGoes) {
    for (const double speed : {10., 100., 1000., 10'000.}) EXPECT_GT(seen_at(speed), .95) << speed;
}

TEST(SceneConditions, ALampIsWhiteWhereTheTruthIsOfGreyValues) {
    const auto grey_of = [](const SceneConditions& conditions) {
        Scene scene{under(conditions, simulation_preset("thesis_test")).scene,
                    procedural_textures(10, 128), kWidth, kHeight, Random{3}};
        scene.prepare(1);
        Array2<float> grey(kHeight, kWidth);
        scene.render(.5, {}, Scene::Show::grey, grey);
        return grey;
    };
    const Array2<float> plain = grey_of({}), lit = grey_of({.lamp = 1000});
    int white = 0;
    for (std::size_t i = 0; i < plain.values().size(); ++i) {
        white += lit.values()[i] == 1;
        EXPECT_GE(lit.values()[i], plain.values()[i]);
    }
    EXPECT_GT(white, 10) << "of a disc of some 28 px, whose edge is soft";
}

TEST(SceneConditions, ThesisScenesHaveNoSpeed) {
    try {
        under({.speed = 10}, simulation_preset("thesis_test"));
        FAIL() << "a speed was taken";
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("thesis_test"));
    }
}

}  // namespace
}  // namespace eventide
