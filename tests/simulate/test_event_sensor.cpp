// Thresholds and photoreceptors of the simulated sensor.
#include "tests/simulate/watched_sensor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace eventide {
namespace {

using namespace watched_sensor;

TEST(EventSensor, SaysNothingBeforeAStillSceneWhenEveryEffectIsOff) {
    EXPECT_TRUE(watch(plain(.1), 2, still).empty());
}

TEST(EventSensor, FiresOnceEveryThresholdAtTheMicrosecondOfTheCrossing) {
    const double rate = 1.7, threshold = .1;  // ln per second
    for (const double sign : {1.0, -1.0}) {
        const auto events =
            watch(plain(threshold), 1, [&](double t) { return 5 + sign * rate * t; });
        ASSERT_EQ(double(events.size()), 17 * kPixels);
        for (const auto& [pixel, times] : times_by_pixel(events))
            for (std::size_t i = 0; i < times.size(); ++i)
                ASSERT_NEAR(double(times[i]), double(i + 1) * threshold / rate * 1e6, 10);
        EXPECT_EQ(share_on(events), sign > 0 ? 1 : 0);
    }
}

TEST(EventSensor, GivesTheSameEventsHoweverFineARampIsCut) {
    const auto ramp = [](double t) { return 3 + 2.3 * t; };
    const auto coarse = times_by_pixel(watch(plain(.2), 1, ramp, 10000));
    const auto fine = times_by_pixel(watch(plain(.2), 1, ramp, 500));
    ASSERT_EQ(coarse.size(), fine.size());
    for (const auto& [pixel, times] : coarse)
        for (std::size_t i = 0; i < times.size(); ++i)
            ASSERT_NEAR(double(times[i]), double(fine.at(pixel)[i]), 20);
}

TEST(EventSensor, HasSeparateThresholdsForOnAndOff) {
    SensorTraits traits = plain(.1);
    traits.threshold_off = .25;
    const auto up = watch(traits, 1, [](double t) { return 4 + 1.01 * t; });
    const auto down = watch(traits, 1, [](double t) { return 4 - 1.01 * t; });
    EXPECT_EQ(double(up.size()), 10 * kPixels);
    EXPECT_EQ(double(down.size()), 4 * kPixels);
}

TEST(EventSensor, SpreadsThresholdsOverPixelsByTheMismatch) {
    SensorTraits traits = plain(.05);
    traits.mismatch = .1;
    const auto events = watch(traits, 1, [](double t) { return 10 * t; });
    std::vector<double> thresholds;
    for (const auto& [pixel, times] : times_by_pixel(events))
        thresholds.push_back(10.0 / double(times.size()));
    const Moments m = moments(thresholds);
    EXPECT_NEAR(m.mean, .05, .001);
    EXPECT_NEAR(m.deviation / m.mean, .1, .01);
}

TEST(EventSensor, NeverHasAThresholdBelowTheSmallest) {
    SensorTraits traits = plain(.05);
    traits.mismatch = 3;
    traits.threshold_min = .04;
    const auto events = watch(traits, 1, [](double t) { return t; });
    for (const auto& [pixel, times] : times_by_pixel(events)) EXPECT_LE(times.size(), 25u);
}

TEST(EventSensor, StartsPixelsAtRandomPhasesWhereAsked) {
    SensorTraits traits = plain(.2);
    traits.random_phase = true;
    const auto events = watch(traits, 1, [](double t) { return .2 * t; });
    // Between half a threshold above and below zero: half the pixels are at most .2 away for sure.
    const auto first = times_by_pixel(events);
    std::vector<double> times;
    for (const auto& [pixel, list] : first) times.push_back(double(list.front()) * 1e-6);
    EXPECT_NEAR(double(times.size()), .5 * kPixels, .05 * kPixels);
    EXPECT_NEAR(moments(times).mean, .5, .04);
}

TEST(EventSensor, StartsNoPixelBeyondItsThresholds) {
    SensorTraits traits = plain(.1);
    traits.random_phase = true;
    for (const auto& [on, off] : {std::pair{.4, .1}, {.1, .4}}) {
        traits.threshold_on = on;
        traits.threshold_off = off;
        EXPECT_TRUE(watch(traits, .1, still).empty()) << on << ' ' << off;
    }
}

TEST(EventSensor, DarkCurrentHidesContrastInTheDark) {
    SensorTraits traits = plain(.01);
    traits.dark_lux = 10;
    const auto count = [&](double lux) {
        return double(watch(traits, 1, [&](double t) { return std::log(lux) + t; }).size()) /
               kPixels;
    };
    EXPECT_NEAR(count(1e5), 100, 1.1);
    EXPECT_NEAR(count(1), 100 * std::log((std::exp(1.0) + 10) / 11), 1.1);
}

/// Time at which a pixel has followed 1 - 1/e of a step of light.
double step_response(double lux) {
    SensorTraits traits = plain(.01);
    traits.bandwidth_hz = 300;
    traits.bandwidth_hz_per_lux = 1;
    const auto events = watch(
        traits, .2, [&](double t) { return std::log(lux) + (t > 1e-9 ? 1 : 0); }, 50);
    const auto times = times_by_pixel(events).begin()->second;
    EXPECT_GE(times.size(), 95u);
    return double(times[62]) * 1e-6;  // the 63rd of 100
}

TEST(EventSensor, FollowsLightWithTheTimeConstantOfItsBandwidth) {
    const double bright = 1e6;
    EXPECT_NEAR(step_response(bright), 1 / (2 * std::numbers::pi * 300), .00005);
}

TEST(EventSensor, FollowsARampByItsTimeConstantLateHoweverItIsCut) {
    SensorTraits traits = plain(.1);
    traits.bandwidth_hz = 20;
    const double tau_us = 1e6 / (2 * std::numbers::pi * 20);
    for (const int step_us : {500, 2000, 10'000, 50'000}) {
        const auto times =
            times_by_pixel(watch(
                               traits, 1, [](double t) { return 3 + 2 * t; }, step_us))
                .begin()
                ->second;
        ASSERT_EQ(times.size(), 19u) << step_us;
        // From the fourth on the ramp's beginning is forgotten.
        for (std::size_t i = 3; i < times.size(); ++i)
            EXPECT_NEAR(double(times[i]), 50'000. * double(i + 1) + tau_us, 500) << step_us;
    }
}

TEST(EventSensor, ApproachesLightThatStaysExponentiallyInAStepOfAnyLength) {
    SensorTraits traits = plain(.005);
    traits.threshold_min = .005;
    traits.bandwidth_hz = 20;
    const double tau_us = 1e6 / (2 * std::numbers::pi * 20), jump = .3;
    for (const double taus : {.1, .4, 1., 1.5, 2.5, 4., 8.}) {
        EventSensor sensor{traits, 4, 1, Random{7}};
        Array2<float> lux(1, 4);
        std::ranges::fill(lux.values(), 100.F);
        sensor.settle(lux, 1);
        std::vector<Event> events;
        // So short a step that none has followed yet.
        sensor.step(from_us(0), from_us(1), lux, std::exp(jump), events);
        ASSERT_TRUE(events.empty());
        sensor.step(from_us(1), from_us(1 + std::llround(taus * tau_us)), lux, std::exp(jump),
                    events);
        const double way = double(events.size()) / 4 * .005 + .0025;
        EXPECT_NEAR(way / jump, 1 - std::exp(-taus), .012 + .0025 / jump) << taus;
    }
}

TEST(EventSensor, IsSlowerInTheDark) {
    const double tau_after = 1 / (2 * std::numbers::pi) * (1. / 300 + 1. / (10 * std::exp(1.0)));
    EXPECT_NEAR(step_response(10), tau_after, .03 * tau_after);
}
TEST(EventSensor, BoundsTheEventsOfOneStep) {
    const auto events = watch(
        plain(.001), .01, [](double t) { return t > 0 ? 10.0 : 0; }, 10000);
    EXPECT_EQ(double(events.size()), kPixels * EventSensor::kMaxPerStep);
    const auto later = watch(
        plain(.001), .03, [](double t) { return t > 0 ? 10.0 : 0; }, 10000);
    EXPECT_EQ(later.size(), events.size()) << "the rest is caught up silently";
}

TEST(EventSensor, WorksForSizesThatFillNoWholeLane) {
    EventSensor sensor{plain(.1), 5, 3, Random{1}};
    Array2<float> lux(3, 5);
    std::ranges::fill(lux.values(), 1.f);
    sensor.settle(lux, 1);
    std::vector<Event> events;
    sensor.step(from_us(0), from_us(100), lux, std::exp(.15), events);
    ASSERT_EQ(events.size(), 15u);
    for (const Event& e : events) EXPECT_TRUE(e.x < 5 && e.y < 3);
}

}  // namespace
}  // namespace eventide
