// Pauses, changes of light, and flicker.
#include "src/simulate/scene/motion.h"
#include "src/simulate/scene/scene.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace eventide {
namespace {

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

TEST(PauseClock, IsThereFromTheTimeOnBeforeWhichItWasForgotten) {
    PauseClock whole{.2, .5, .03, Random{3}}, part{.2, .5, .03, Random{3}};
    whole.prepare(40);
    for (double t = 0; t < 20; t += .01) {
        part.prepare(t + 20);
        part.forget(t);
        ASSERT_EQ(whole.at(t), part.at(t)) << t;
    }
}

TEST(LightChanges, IsThereFromTheTimeOnBeforeWhichItWasForgotten) {
    LightChanges whole{.7, .1, Random{4}}, part{.7, .1, Random{4}};
    whole.prepare(40);
    for (double t = 0; t < 20; t += .01) {
        part.prepare(t + 20);
        part.forget(t);
        ASSERT_EQ(whole.log_gain(t), part.log_gain(t)) << t;
    }
}

TEST(LightChanges, BeginsAnywhereInItsDepth) {
    double mean = 0;
    for (std::uint64_t seed = 0; seed < 400; ++seed) {
        LightChanges light{.8, .1, Random{seed}};
        light.prepare(1);
        mean += light.log_gain(0) / 400;
    }
    EXPECT_NEAR(mean, -.4, .05);
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

TEST(LightChanges, StaysAsItIsInHalfOfItsSteps) {
    LightChanges light{.7, .1, Random{4}};
    light.prepare(201);
    int still = 0;
    for (int k = 0; k < 2000; ++k)
        still += light.log_gain((k + .25) * .1) == light.log_gain((k + .75) * .1);
    EXPECT_NEAR(still / 2000., .5, .05);
}

TEST(Flicker, HasItsFrequencyAndDepth) {
    const Flicker flicker{.depth = .4, .frequency_hz = 100, .phase = 0};
    EXPECT_NEAR(flicker.at(.01), 1.4, 1e-9);
    EXPECT_NEAR(flicker.at(.005), .6, 1e-9);
    EXPECT_EQ(Flicker{}.at(.123), 1);
}

}  // namespace
}  // namespace eventide
