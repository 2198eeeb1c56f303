// Where in its image a scene of the thesis looks.
#include "src/simulate/presets.h"
#include "src/simulate/scene/scene.h"
#include "tests/simulate/textures_of.h"

#include <gtest/gtest.h>

#include <cmath>

namespace eventide {
namespace {

TEST(Scene, ShowsTheWholeImageAtTheStartOfAThesisScene) {
    GreyImage image(32, 32);
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) image(y, x) = std::uint8_t(y * 8);
    Scene scene{simulation_preset("thesis_train").scene, test::textures_of(image), 65, 33,
                Random{1}};
    scene.prepare(1);
    Array2<float> rendered(33, 65);
    scene.render(0, {}, Scene::Show::grey, rendered);
    // [-1, 1] are the image's edges and the first and last samples lie on them.
    EXPECT_NEAR(rendered(0, 30), 0, .02);
    EXPECT_NEAR(rendered(16, 30), .5, .02);
    EXPECT_NEAR(rendered(32, 30), 1, .02);
}

/// A scene of the thesis before an image whose grey values grow to the right, or downwards.
Scene before_a_ramp(const SceneSettings& settings, std::uint64_t seed, bool downwards) {
    GreyImage image(256, 256);
    for (int y = 0; y < 256; ++y)
        for (int x = 0; x < 256; ++x) image(y, x) = std::uint8_t(downwards ? y : x);
    Scene scene{settings, test::textures_of(image), 65, 65, Random{seed}};
    scene.prepare(10);
    return scene;
}

/// From the sensor to the image, [-1, 1] each, as the grey values of both ramps tell it.
Affine seen_transform(const Scene& to_the_right, const Scene& downwards, double t_s) {
    const auto place_of = [&](const Scene& scene, double x, double y) {
        Array2<float> one(1, 1);  // near the middle, where nothing is mirrored
        scene.render(t_s, Affine::translation(32 + 32 * x, 32 + 32 * y), Scene::Show::grey, one);
        return 2 * double(one(0, 0)) - 1;
    };
    Affine seen;
    const auto row = [&](const Scene& scene, double& x, double& y, double& offset) {
        constexpr double kNear = .1;
        offset = place_of(scene, 0, 0);
        x = (place_of(scene, kNear, 0) - offset) / kNear;
        y = (place_of(scene, 0, kNear) - offset) / kNear;
    };
    row(to_the_right, seen.xx, seen.xy, seen.x0);
    row(downwards, seen.yx, seen.yy, seen.y0);
    return seen;
}

TEST(Scene, OfTheThesisIsTurnedThenDisplacedThenScaled) {
    SceneSettings settings = simulation_preset("thesis_train").scene;
    settings.thesis.control_points_max = 2;  // all values go straight from the start to the end
    settings.thesis.displacement_max = .2;
    settings.thesis.linear_probability = 1;
    int turned = 0, stretched = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const Scene right = before_a_ramp(settings, seed, false);
        const Scene down = before_a_ramp(settings, seed, true);
        const auto seen = [&](double share) {
            return seen_transform(right, down, share * settings.thesis.duration_s);
        };
        const auto scale_x = [](const Affine& a) { return 1 / std::hypot(a.xx, a.xy); };
        const auto scale_y = [](const Affine& a) { return 1 / std::hypot(a.yx, a.yy); };
        const Affine half = seen(.5), whole = seen(1);
        // Turned first: the image's axes stay at right angles on the sensor, whatever their scales.
        EXPECT_NEAR(whole.xx * whole.yx + whole.xy * whole.yy, 0, .05) << seed;
        EXPECT_NEAR(scale_x(whole) - 1, 2 * (scale_x(half) - 1), .05) << seed;
        // Displaced after that, along the axes that the scale is of.
        EXPECT_NEAR(whole.x0 * scale_x(whole), 2 * half.x0 * scale_x(half), .02) << seed;
        EXPECT_NEAR(whole.y0 * scale_y(whole), 2 * half.y0 * scale_y(half), .02) << seed;
        turned += std::abs(whole.xy) > .3;
        stretched += std::abs(scale_x(whole) - scale_y(whole)) > .2;
    }
    EXPECT_GE(turned, 4);
    EXPECT_GE(stretched, 4);
}

}  // namespace
}  // namespace eventide
