// How light becomes an image: level and contrast, gamma, and an exposure that follows the light.
#include "src/simulate/sensor/exposure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace eventide {
namespace {

/// An exposure of which nothing is left to chance.
SceneSettings exposed(double mean, double deviation) {
    SceneSettings settings;
    settings.target_mean = {mean, mean};
    settings.target_deviation = {deviation, deviation};
    settings.target_black = {-.25, .15};
    settings.target_white_below_one = 0;
    settings.target_gamma = {1, 1};
    settings.exposure_fixed = 0;
    settings.exposure_lag_s = {1, 1};
    return settings;
}

/// Dark on the left, bright on the right.
Array2<float> halves(float dark, float bright) {
    Array2<float> light(32, 32);
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) light(y, x) = x < 16 ? dark : bright;
    return light;
}

/// Left and right of `light` as they are developed at t.
struct Levels {
    double dark = 0, bright = 0;
};
Levels developed(const Exposure& exposure, double t_s, double gain, Array2<float> light) {
    exposure.develop(t_s, gain, light);
    return {double(light(5, 3)), double(light(20, 28))};
}

TEST(Exposure, GivesTheMeanAndTheDeviationAskedFor) {
    // Signal 1 +- .5: of .4 +- .3 black lies at -.2, of .4 +- .08 at .15 at most.
    const Array2<float> light = halves(50, 150);
    Exposure strong{exposed(.4, .3), Random{1}};
    strong.meter(0, light, 1);
    const Levels far = developed(strong, 0, 1, light);
    EXPECT_NEAR(far.dark, .1, 1e-3);
    EXPECT_NEAR(far.bright, .7, 1e-3);
    Exposure faint{exposed(.4, .08), Random{1}};
    faint.meter(0, light, 1);
    const Levels near = developed(faint, 0, 1, light);
    EXPECT_NEAR(near.dark, .15 + .25 * .5, 1e-3) << "mean first: black is not any level";
    EXPECT_NEAR(near.bright, .15 + .25 * 1.5, 1e-3);
}

TEST(Exposure, BlackIsNoLowerThanItMayBe) {
    SceneSettings settings = exposed(.4, .3);
    settings.target_black = {-.1, .15};
    const Array2<float> light = halves(50, 150);
    Exposure exposure{settings, Random{1}};
    exposure.meter(0, light, 1);
    const Levels levels = developed(exposure, 0, 1, light);
    EXPECT_NEAR(levels.dark, -.1 + .5 * .5, 1e-3);
    EXPECT_NEAR(levels.bright, -.1 + .5 * 1.5, 1e-3);
}

TEST(Exposure, IsMeteredAllOverTheImage) {
    for (int side = 0; side < 4; ++side) {
        Array2<float> light(32, 32);
        for (int y = 0; y < 32; ++y)
            for (int x = 0; x < 32; ++x) {
                const int from_side[] = {y, 31 - y, x, 31 - x};
                light(y, x) = from_side[side] < 2 ? .4F : .1F;
            }
        SceneSettings settings = exposed(.4, .1);
        settings.target_black = {0, 0};
        Exposure exposure{settings, Random{1}};
        exposure.meter(0, light, 1);
        exposure.develop(0, 1, light);
        double mean = 0;
        for (const float v : light.values()) mean += double(v) / (32 * 32);
        EXPECT_NEAR(mean, .4, 1e-3) << "brighter at side " << side;
    }
}

TEST(Exposure, TheMeanIsThatOfWhatIsCutOffAtWhiteAndAtBlack) {
    // A sixteenth is a lamp: by the plain mean all else would be black.
    Array2<float> light(32, 32);
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) light(y, x) = x < 30 ? 10 : 4e3F;
    SceneSettings settings = exposed(.4, .1);
    settings.target_black = {0, 0};
    Exposure lit{settings, Random{1}};
    lit.meter(0, light, 1);
    const Levels levels = developed(lit, 0, 1, light);
    EXPECT_NEAR(levels.dark, (.4 - 1. / 16) * 16 / 15, 2e-3);
    lit.develop(0, 1, light);
    EXPECT_EQ(light(9, 31), 1);
    // Half of it is below a black of -.25, and is 0.
    settings.target_black = {-.25, -.25};
    settings.target_mean = {.2, .2};
    Exposure dim{settings, Random{1}};
    const Array2<float> dark_half = halves(1, 200);
    dim.meter(0, dark_half, 1);
    const Levels cut = developed(dim, 0, 1, dark_half);
    EXPECT_EQ(cut.dark, 0);
    EXPECT_NEAR(cut.bright, .4, 2e-3);
}

TEST(Exposure, BlackIsAtMostHalfOfTheMean) {
    SceneSettings settings = exposed(.2, .02);
    settings.target_black = {.3, .4};
    const Array2<float> light = halves(50, 150);
    Exposure exposure{settings, Random{1}};
    exposure.meter(0, light, 1);
    const Levels levels = developed(exposure, 0, 1, light);
    EXPECT_NEAR(levels.dark, .1 + .1 * .5, 1e-3);
    EXPECT_NEAR(levels.bright, .1 + .1 * 1.5, 1e-3);
}

TEST(Exposure, NoSensorThatSaturatesEarlyIsBright) {
    SceneSettings settings = exposed(.54, .1);
    settings.target_white_below_one = 1;
    settings.target_white = {.5, .5};
    Exposure exposure{settings, Random{1}};
    const Array2<float> light = halves(50, 150);
    exposure.meter(0, light, 1);
    const Levels levels = developed(exposure, 0, 1, light);
    EXPECT_NEAR((levels.dark + levels.bright) / 2, .3, 1e-3) << "six tenths of its range";
    EXPECT_EQ(developed(exposure, 0, 1, halves(50, 1e4)).bright, .5) << "and no more";
}

TEST(Exposure, GainIsLight) {
    SceneSettings settings = exposed(.4, .2);
    settings.target_gamma = {2, 2};
    Exposure one{settings, Random{1}}, other{settings, Random{1}};
    one.meter(0, halves(40, 160), 1);
    other.meter(0, halves(10, 40), 4);
    const Levels a = developed(one, 0, 1, halves(40, 160)),
                 b = developed(other, 0, 4, halves(10, 40));
    EXPECT_NEAR(a.dark, b.dark, 1e-4);
    EXPECT_NEAR(a.bright, b.bright, 1e-4);
    // Signal 1 : 2 of light 1 : 4.
    const Levels c = developed(one, 0, 1, halves(90, 160));
    EXPECT_NEAR((c.dark - a.dark) / (a.bright - a.dark), .5, 1e-3);
}

TEST(Exposure, FollowsTheLightWithItsLagAndAnImageHasThatOfItsTime) {
    Exposure exposure{exposed(.3, .15), Random{1}};  // black at 0
    exposure.meter(0, halves(50, 150), 1);
    const double before = developed(exposure, 0, 1, halves(50, 150)).bright;
    EXPECT_NEAR(before, .45, 1e-3);
    EXPECT_FALSE(exposure.due(.01));
    ASSERT_TRUE(exposure.due(.5));
    exposure.meter(.5, halves(50, 150), 2);
    const double share = 1 - std::exp(-.5);
    EXPECT_NEAR(developed(exposure, .5, 1, halves(50, 150)).bright / before, std::pow(.5, share),
                1e-3);
    EXPECT_NEAR(developed(exposure, .4, 1, halves(50, 150)).bright, before, 1e-6)
        << "of a time before it was metered again";
    exposure.meter(1, halves(50, 150), 2);
    exposure.forget(.7);
    EXPECT_NEAR(developed(exposure, 1, 1, halves(50, 150)).bright / before,
                std::pow(.5, 1 - std::exp(-1)), 1e-3);
    EXPECT_NEAR(developed(exposure, .8, 1, halves(50, 150)).bright / before, std::pow(.5, share),
                1e-3)
        << "metered before what was forgotten";
}

TEST(Exposure, DevelopsImagesOfAnyNumberOfPixels) {
    Exposure exposure{exposed(.3, .15), Random{1}};
    exposure.meter(0, halves(50, 150), 1);
    for (const int width : {1, 2, 3, 4, 5, 7, 8}) {
        Array2<float> image(1, width);
        std::ranges::fill(image.values(), 150.F);
        exposure.develop(0, 1, image);
        for (const float v : image.values()) EXPECT_NEAR(v, .45, 1e-3) << width;
    }
}

TEST(Exposure, ThatIsFixedStaysAsItBegan) {
    SceneSettings settings = exposed(.3, .15);
    settings.exposure_fixed = 1;
    Exposure exposure{settings, Random{1}};
    exposure.meter(0, halves(50, 150), 1);
    EXPECT_FALSE(exposure.due(10));
    exposure.meter(10, halves(50, 150), 3);
    EXPECT_NEAR(developed(exposure, 10, 1, halves(50, 150)).bright, .45, 1e-3);
}

}  // namespace
}  // namespace eventide
