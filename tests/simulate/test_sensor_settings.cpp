// Simulated sensors as their settings draw them.
#include "tests/simulate/watched_sensor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace eventide {
namespace {

using namespace watched_sensor;

TEST(SensorSettings, IdealIsFreeOfEveryEffect) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        Random random{seed};
        const SensorTraits t = SensorTraits::draw(SensorSettings::ideal(.3), random);
        EXPECT_DOUBLE_EQ(t.threshold_on, .3);
        EXPECT_DOUBLE_EQ(t.threshold_off, .3);
        for (const double off :
             {t.mismatch, t.dark_lux, t.bandwidth_hz, t.bandwidth_hz_per_lux, t.refractory_s,
              t.leak_hz, t.shot_hz, t.hot_share, t.jitter_s, t.arbiter_hz_per_pixel, t.dropped})
            EXPECT_EQ(off, 0);
    }
}

TEST(SensorSettings, DrawsThresholdsEvenlyInTheLogarithmOverTheWholeRange) {
    Random random{3};
    std::vector<double> logs;
    for (int i = 0; i < 4000; ++i)
        logs.push_back(std::log(SensorTraits::draw({}, random).threshold_on));
    EXPECT_NEAR(std::ranges::min(logs), std::log(.06), .02);
    EXPECT_NEAR(std::ranges::max(logs), std::log(1.0), .02);
    EXPECT_NEAR(moments(logs).mean, std::log(.06) / 2, .05);
}

TEST(SensorSettings, DrawsEachTraitFromItsRangeAndLeavesOutEffectsAsOftenAsItSays) {
    Random random{5};
    constexpr int kCameras = 6000;
    double ratio = 0, mismatch = 0, shot_mismatch = 0, leak = 0, noisy = 0, instant = 0, exact = 0;
    for (int i = 0; i < kCameras; ++i) {
        const SensorTraits t = SensorTraits::draw({}, random);
        ratio += std::log(t.threshold_off / t.threshold_on) / kCameras;
        mismatch += t.mismatch / kCameras;
        if (t.shot_hz > 0) {
            ++noisy;
            shot_mismatch += t.shot_mismatch;
            leak += t.leak_hz;
        }
        instant += t.bandwidth_hz == 0;
        exact += t.jitter_s == 0 && t.dropped == 0;
        EXPECT_GT(t.arbiter_hz_per_pixel, 0) << "the bus's limit stays";
    }
    EXPECT_NEAR(ratio, (std::log(.6) + std::log(1.6)) / 2, .015);
    EXPECT_NEAR(mismatch, (.01 + .12) / 2, .002);
    EXPECT_NEAR(shot_mismatch / noisy, (.2 + 1.2) / 2, .02);
    EXPECT_NEAR(leak / noisy, .2, .01);
    EXPECT_NEAR(noisy / kCameras, .85, .02);
    EXPECT_NEAR(instant / kCameras, .2, .02);
    EXPECT_NEAR(exact / kCameras, .3, .02);
}

}  // namespace
}  // namespace eventide
