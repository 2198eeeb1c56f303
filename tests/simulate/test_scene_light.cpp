// Light of scenes: glass, soft edges, lamps that flicker, and steps short enough for them.
#include "src/simulate/scene/scene.h"
#include "src/simulate/scene/textures.h"
#include "src/simulate/sensor/sensor_settings.h"
#include "src/simulate/simulated_stream.h"
#include "tests/simulate/textures_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace eventide {
namespace {

constexpr int kWidth = 48, kHeight = 36;

Scene make_scene(const SceneSettings& settings, std::uint64_t seed,
                 std::shared_ptr<const TextureLibrary> textures) {
    Scene scene{settings, std::move(textures), kWidth, kHeight, Random{seed}};
    scene.prepare(5);
    return scene;
}

/// A camera and things that stand still in a light that stays as it is.
SceneSettings standing() {
    SceneSettings settings;
    settings.objects_min = settings.objects_max = 3;
    settings.object_size = {.4, .6};
    settings.still_background = 1;
    settings.wander.speed = settings.wander.usual_speed = {1e-6, 1e-6};
    settings.object_speed = {1, 1};
    settings.flicker_probability = settings.object_flicker_probability = 0;
    settings.light_change_probability = settings.faint_probability = 0;
    return settings;
}

Array2<float> light_of(const Scene& scene, double t_s, int scale = 1) {
    Array2<float> light((kHeight - 1) * scale + 1, (kWidth - 1) * scale + 1);
    scene.render(t_s, Affine::scale(1.0 / scale, 1.0 / scale), Scene::Show::light, light);
    return light;
}

TEST(SceneLight, GlassLetsThroughWhatItDoesNotCover) {
    SceneSettings settings = standing();
    settings.objects_min = settings.objects_max = 1;
    const auto textures = procedural_textures(10, 128);
    int seen = 0;
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
        const auto with = [&](double opacity) {
            settings.opacity = {opacity, opacity};
            return light_of(make_scene(settings, seed, textures), 0);
        };
        const Array2<float> none = with(0), whole = with(1), glass = with(.25);
        for (std::size_t i = 0; i < none.values().size(); ++i)
            ASSERT_NEAR(glass.values()[i], .75F * none.values()[i] + .25F * whole.values()[i],
                        1e-4F * whole.values()[i]);
        seen += none != whole;
    }
    EXPECT_GE(seen, 4);
}

TEST(SceneLight, EdgesAreAsSoftAtEverySizeOfAnImage) {
    SceneSettings settings = standing();
    settings.object_gain = {3, 3};
    settings.polygon_probability = 0;  // whose sharp corners end where their box does
    const auto textures = test::one_grey();
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        settings.edge_softness_px = seed % 2 == 0 ? Range{6, 6} : Range{2, 2};
        const Scene scene = make_scene(settings, seed, textures);
        const Array2<float> once = light_of(scene, 0), thrice = light_of(scene, 0, 3);
        const auto [darkest, brightest] = std::ranges::minmax(once.values());
        EXPECT_GT(brightest, 1.5F * darkest) << "something is seen";
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x)
                ASSERT_NEAR(thrice(3 * y, 3 * x), once(y, x), .02F * brightest) << seed;
    }
}

TEST(SceneLight, StepsAreShortEnoughForMotionAndForLamps) {
    SceneSettings settings = standing();
    const auto textures = procedural_textures(10, 128);
    const auto steps_in_a_second = [&](std::uint64_t seed) {
        const Scene scene = make_scene(settings, seed, textures);
        int steps = 0;
        for (double t = 0; t < 1; ++steps) t += scene.step(t);
        return steps;
    };
    EXPECT_EQ(steps_in_a_second(1), 100);
    settings.pause_start = 0;
    settings.object_pauses = 0;
    settings.still_background = 0;
    settings.wander.speed = settings.wander.usual_speed = {200, 200};
    settings.wander.linear_probability = 1;
    settings.objects_min = settings.objects_max = 0;
    double mean = 0;
    for (std::uint64_t seed = 0; seed < 12; ++seed) mean += steps_in_a_second(seed) / 12.0;
    EXPECT_GT(mean, 200 / settings.step_px) << "200 px at half a pixel each";
    EXPECT_LT(mean, 2 * 200 / settings.step_px);

    settings = standing();
    settings.flicker_probability = 1;
    settings.flicker_depth = {.5, .5};
    for (std::uint64_t seed = 0; seed < 6; ++seed)
        EXPECT_GE(steps_in_a_second(seed), 16 * 50 - 1) << "16 in a period of 50 Hz or more";
    settings.flicker_probability = 0;
    settings.light_change_probability = 1;
    settings.light_change = {1.2, 1.2};
    settings.light_change_s = {.05, .05};
    EXPECT_GE(steps_in_a_second(1), 239) << "ln of the light goes by .1 at most: 24 per second";
}

/// How far the truth changes in a quarter of a second.
double change_of_truth(SimulatedStream& stream, std::vector<Event>& events) {
    Array2<float> first(kHeight, kWidth), later(kHeight, kWidth);
    stream.truth(stream.now(), first);
    double change = 0;
    for (int ms = 3; ms <= 250; ms += 3) {
        stream.advance(from_us(1000 * ms), events);
        stream.truth(stream.now(), later);
        for (std::size_t i = 0; i < later.values().size(); ++i)
            change = std::max(change, double(std::abs(later.values()[i] - first.values()[i])));
    }
    return change;
}

TEST(SceneLight, LampsFlickerForTheSensorAndNotInTheTruth) {
    SceneSettings settings = standing();
    settings.exposure_fixed = 1;
    const auto textures = procedural_textures(10, 128);
    const auto events_of = [&] {
        std::size_t n = 0;
        for (std::uint64_t seed = 0; seed < 4; ++seed) {
            SimulatedStream stream{settings, SensorSettings::ideal(.1), textures, kWidth, kHeight,
                                   seed};
            std::vector<Event> events;
            EXPECT_LT(change_of_truth(stream, events), .01) << seed;
            n += events.size();
        }
        return double(n) / (4 * kWidth * kHeight);
    };
    EXPECT_LT(events_of(), .01) << "per pixel";
    settings.flicker_depth = {.5, .5};
    settings.flicker_probability = 1;
    // ln 3 up and down each period: 10 events each way, 50 Hz or more.
    EXPECT_GT(events_of(), .25 * 50 * 18);
    settings.flicker_probability = 0;
    settings.object_flicker_probability = 1;
    EXPECT_GT(events_of(), 1) << "of what shines by itself";
}

}  // namespace
}  // namespace eventide
