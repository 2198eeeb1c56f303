// What moves in scenes, what stands still, and how short their steps are.
#include "tests/simulate/scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace eventide::test {
namespace {

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

}  // namespace
}  // namespace eventide::test
