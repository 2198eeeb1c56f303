// Sizes, shapes and ways of the things in scenes, and of the picture behind them.
#include "src/simulate/conditions.h"
#include "src/simulate/presets.h"
#include "src/simulate/scene/scene.h"
#include "src/simulate/scene/textures.h"
#include "tests/simulate/textures_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace eventide {
namespace {

constexpr int kWidth = 96, kHeight = 32;

/// One bright disc that wanders before a still background.
SceneSettings one_disc() {
    SceneSettings settings;
    settings.objects_min = settings.objects_max = 1;
    settings.polygon_probability = settings.ring_probability = 0;
    settings.object_gain = {3, 3};
    settings.object_speed = {1, 1};
    settings.object_pauses = settings.pause_start = 0;
    settings.still_background = 1;
    settings.edge_softness_px = {0, 0};
    settings.flicker_probability = settings.object_flicker_probability = 0;
    settings.light_change_probability = settings.faint_probability = 0;
    return settings;
}

Scene make_scene(const SceneSettings& settings, std::uint64_t seed,
                 std::shared_ptr<const TextureLibrary> textures = test::one_grey()) {
    Scene scene{settings, std::move(textures), kWidth, kHeight, Random{seed}};
    scene.prepare(20);
    return scene;
}

struct Seen {
    double area = 0;      // px
    double x = 0, y = 0;  // its middle
};

/// What is brighter than the background, on the sensor and up to 200 px around it.
Seen bright_thing(const Scene& scene, double t_s) {
    constexpr int kAround = 200;
    Array2<float> light(kHeight + 2 * kAround, kWidth + 2 * kAround);
    scene.render(t_s, Affine::translation(-kAround, -kAround), Scene::Show::light, light);
    const auto [low, high] = std::ranges::minmax(light.values());
    Seen seen;
    for (int y = 0; y < light.height(); ++y)
        for (int x = 0; x < light.width(); ++x) {
            const double share = double((light(y, x) - low) / (high - low));
            seen.area += share;
            seen.x += share * (x - kAround);
            seen.y += share * (y - kAround);
        }
    seen.x /= seen.area;
    seen.y /= seen.area;
    return seen;
}

TEST(SceneThings, AreAsLongAsTheirShareOfTheShorterSide) {
    SceneSettings settings = one_disc();
    settings.object_size = {.5, .5};
    for (const double aspect : {1., .4}) {
        settings.object_aspect = {aspect, aspect};
        for (std::uint64_t seed = 0; seed < 5; ++seed) {
            const double length = .5 * kHeight;
            EXPECT_NEAR(bright_thing(make_scene(settings, seed), 0).area,
                        std::numbers::pi / 4 * length * length * aspect, .05 * length * length);
        }
    }
}

TEST(SceneThings, RoamOverAllOfTheSensorAndBeyondItAsFarAsTheyMay) {
    SceneSettings settings = one_disc();
    settings.object_size = settings.object_aspect = {.4, .4};
    settings.wander.speed = settings.wander.usual_speed = {20, 20};
    settings.wander.leg_s = {.1, .1};
    const double length = .4 * kHeight;
    for (const double reach : {0., 2.}) {
        settings.object_reach = reach;
        double left = kWidth, right = 0, top = kHeight, bottom = 0;
        for (std::uint64_t seed = 0; seed < 12; ++seed) {
            const Scene scene = make_scene(settings, seed);
            for (int s = 0; s < 20; s += 2) {
                const Seen thing = bright_thing(scene, s);
                left = std::min(left, thing.x);
                right = std::max(right, thing.x);
                top = std::min(top, thing.y);
                bottom = std::max(bottom, thing.y);
            }
        }
        const double slack = 8;  // the leg that turns back, and what was not drawn
        EXPECT_NEAR(left, -reach * length, slack) << reach;
        EXPECT_NEAR(right, kWidth + reach * length, slack) << reach;
        EXPECT_NEAR(top, -reach * length, slack) << reach;
        EXPECT_NEAR(bottom, kHeight + reach * length, slack) << reach;
    }
}

TEST(SceneThings, AreNeverFasterThanTheFastestAllowed) {
    SceneSettings settings = one_disc();
    settings.object_speed = {5, 5};
    settings.wander.speed = settings.wander.usual_speed = {20, 20};
    settings.wander.linear_probability = 1;
    double way = 0;
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const Scene scene = make_scene(settings, seed);
        const Seen a = bright_thing(scene, 1), b = bright_thing(scene, 1.02);
        way += std::hypot(b.x - a.x, b.y - a.y) / 10;
    }
    EXPECT_LT(way / .02, 40) << "px/s; 100 would be five times the scene's";
}

TEST(SceneThings, LampsStayInViewWhereTheyAreNotFast) {
    SceneSettings settings = under({.speed = 40, .lamp = 1e5}, simulation_preset("camera")).scene;
    settings.wander.leg_s = {.05, .05};
    settings.wander.linear_probability = 1;
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        const Scene scene = make_scene(settings, seed);
        for (int s = 4; s < 20; s += 2) {  // it starts anywhere
            const Seen lamp = bright_thing(scene, s);
            const double radius = kHeight / 8. / 2;  // and nearer or farther now and then
            EXPECT_NEAR(std::log(lamp.area / (std::numbers::pi * radius * radius)), 0, 1.3);
            EXPECT_GT(lamp.x, radius - 1);
            EXPECT_LT(lamp.x, kWidth - radius + 1);
            EXPECT_GT(lamp.y, radius - 1);
            EXPECT_LT(lamp.y, kHeight - radius + 1);
        }
    }
}

TEST(SceneThings, EdgesAreNeverSharperThanAPixel) {
    const SceneSettings settings = one_disc();
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
        const Scene scene = make_scene(settings, seed);
        Array2<float> light(kHeight, kWidth);
        scene.render(0, {}, Scene::Show::light, light);
        const auto [low, high] = std::ranges::minmax(light.values());
        const auto between = std::ranges::count_if(light.values(), [&](float v) {
            return v > low + .1F * (high - low) && v < high - .1F * (high - low);
        });
        EXPECT_GT(between, 3) << "pixels that are covered in part";
    }
}

/// Grey values that rise to the right, or downwards, by one step a pixel.
std::shared_ptr<const TextureLibrary> ramp(int width, int height, bool downwards) {
    GreyImage image(height, width);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) image(y, x) = std::uint8_t(downwards ? y : x);
    auto textures = std::make_shared<TextureLibrary>();
    textures->add(image);
    return textures;
}

TEST(SceneThings, PicturesKeepTheirProportionsAndAreNotMagnifiedTooMuch) {
    SceneSettings settings = one_disc();
    settings.objects_min = settings.objects_max = 0;
    const auto pixels_per_sensor_pixel = [&](int width, int height, bool downwards) {
        double most = 0;  // where no mirror is between
        for (std::uint64_t seed = 0; seed < 5; ++seed) {
            Array2<float> grey(4, 4);
            make_scene(settings, seed, ramp(width, height, downwards))
                .render(0, Affine::translation(40, 14), Scene::Show::grey, grey);
            const double rise =
                double(downwards ? grey(3, 0) - grey(0, 0) : grey(0, 3) - grey(0, 0));
            most = std::max(most, std::abs(rise) / 3 * ((downwards ? height : width) - 1));
        }
        return most;
    };
    settings.view_share = {.5, .5};  // half of the picture's shorter side on the sensor's
    EXPECT_NEAR(pixels_per_sensor_pixel(256, 128, false), 2, .1);
    EXPECT_NEAR(pixels_per_sensor_pixel(256, 128, true), 2, .1);
    EXPECT_NEAR(pixels_per_sensor_pixel(128, 256, false), 2, .1);
    EXPECT_NEAR(pixels_per_sensor_pixel(128, 256, true), 2, .1);
    settings.view_share = {.01, .01};
    settings.magnified_most = 2;
    EXPECT_NEAR(pixels_per_sensor_pixel(128, 128, false), .5, .05);
}

}  // namespace
}  // namespace eventide
