// What differs between a sensor's pixels, and between their ON and OFF events.
#include "tests/simulate/watched_sensor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

namespace eventide::watched_sensor {
namespace {

/// Of each pixel, from the number of events of a ramp of 10.
std::vector<double> thresholds(const SensorTraits& traits, double sign) {
    std::vector<double> all;
    for (const auto& [pixel, times] :
         times_by_pixel(watch(traits, 1, [&](double t) { return 5 + sign * 10 * t; })))
        all.push_back(10.0 / double(times.size()));
    return all;
}

TEST(Pixels, HaveThresholdsOfTheirOwnForOnAndForOff) {
    SensorTraits traits = plain(.05);
    traits.threshold_off = .08;
    traits.mismatch = .1;
    const auto on = thresholds(traits, 1), off = thresholds(traits, -1);
    const Moments of_on = moments(on), of_off = moments(off);
    EXPECT_NEAR(of_on.mean, .05, .001);
    EXPECT_NEAR(of_off.mean, .08, .001);
    EXPECT_NEAR(of_on.deviation / of_on.mean, .1, .01);
    EXPECT_NEAR(of_off.deviation / of_off.mean, .1, .01);
    double together = 0;
    for (std::size_t i = 0; i < on.size(); ++i)
        together += (on[i] - of_on.mean) * (off[i] - of_off.mean) / double(on.size());
    EXPECT_NEAR(together / (of_on.deviation * of_off.deviation), 0, .1) << "independently";
}

TEST(Pixels, StartAnywhereBetweenTheirTwoThresholds) {
    SensorTraits traits = plain(.2);
    traits.threshold_off = .4;
    traits.random_phase = true;
    // A half has its reference above the light, and is less than a threshold from OFF; the other
    // half below it, and from ON.
    for (const auto& [sign, threshold] : {std::pair{1.0, .2}, {-1.0, .4}}) {
        std::vector<double> first;
        const double way = sign * threshold;
        for (const auto& [pixel, times] :
             times_by_pixel(watch(traits, 1, [&](double t) { return 4 + way * t; })))
            first.push_back(double(times.front()) * 1e-6);
        EXPECT_NEAR(double(first.size()), .5 * kPixels, .05 * kPixels) << sign;
        EXPECT_NEAR(moments(first).mean, .5, .04) << sign;
        EXPECT_NEAR(moments(first).deviation, std::sqrt(1 / 12.), .02) << sign;
    }
}

TEST(Pixels, LeakByTheirThresholdForOn) {
    SensorTraits traits = plain(.1);
    traits.threshold_off = .35;
    traits.leak_hz = 3;
    const auto events = watch(traits, 10, still, 10000);
    EXPECT_EQ(share_on(events), 1);
    EXPECT_NEAR(double(events.size()) / kPixels, 30, 1);
}

TEST(Pixels, SeeTheLightTimesItsGain) {
    SensorTraits traits = plain(.1);
    traits.dark_lux = 2;
    traits.bandwidth_hz_per_lux = 10;
    traits.shot_hz = 50;
    traits.shot_lux = 20;
    std::vector<Event> events[2];
    for (const std::size_t how : {0U, 1U}) {
        // Once as 8 lux that grow, once as 1/2 lux times 16, which grows.
        EventSensor sensor{traits, kSide, kSide, Random{7}};
        Array2<float> lux(kSide, kSide);
        for (int i = 0; i <= 100; ++i) {
            const double growth = 1 + .02 * i, light = how == 0 ? 8 * growth : .5,
                         gain = how == 0 ? 1 : 16 * growth;
            std::ranges::fill(lux.values(), float(light));
            if (i == 0)
                sensor.settle(lux, gain);
            else
                sensor.step(from_us(1000 * (i - 1)), from_us(1000 * i), lux, gain, events[how]);
        }
    }
    EXPECT_GT(events[0].size(), 5 * std::size_t(kPixels));
    // Rounding may move an event by a microsecond, or one across a threshold.
    EXPECT_NEAR(double(events[0].size()), double(events[1].size()), 20);
    EXPECT_EQ(share_on(events[0]) > .8, share_on(events[1]) > .8);
}

TEST(Pixels, AreAllNoisy) {
    SensorTraits traits = plain(.3);
    traits.shot_hz = 20;
    traits.shot_lux = 1e9;
    EXPECT_EQ(double(times_by_pixel(watch(traits, 5, still)).size()), kPixels);
}

TEST(Pixels, ThatAreHotMostlyFireOn) {
    SensorTraits traits = plain(.3);
    traits.hot_share = 1;
    traits.hot_hz = {50, 50};
    const auto events = watch(traits, 4, still);
    std::map<int, bool> only_on;
    for (const Event& e : events)
        only_on.try_emplace(e.y * kSide + e.x, true).first->second &= e.polarity == Polarity::on;
    // Six of ten fire ON alone, the others both in any proportion. Places are drawn one by one, so
    // that some pixels are hot twice: of 1 - 1/e that are at all, exp(-.4) - 1/e have only such.
    EXPECT_NEAR(share_on(events), .8, .02);
    EXPECT_NEAR(double(only_on.size()) / kPixels, 1 - std::exp(-1.0), .04);
    const auto ones = std::ranges::count_if(only_on, [](const auto& at) { return at.second; });
    EXPECT_NEAR(double(ones) / kPixels, std::exp(-.4) - std::exp(-1.0), .04);
}

}  // namespace
}  // namespace eventide::watched_sensor
