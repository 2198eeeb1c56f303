// Each effect of the simulated sensor, by its statistics.
#include "tests/simulate/watched_sensor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
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

TEST(EventSensor, LeaksOnEventsAtTheRateAskedFor) {
    SensorTraits traits = plain(.2);
    traits.leak_hz = 3;
    const auto events = watch(traits, 10, still, 10000);
    EXPECT_EQ(share_on(events), 1);
    EXPECT_NEAR(double(events.size()) / kPixels, 30, 1);
    const auto times = times_by_pixel(events).begin()->second;
    for (std::size_t i = 1; i < times.size(); ++i)
        EXPECT_NEAR(double(times[i] - times[i - 1]), 1e6 / 3, 100);
}

TEST(EventSensor, LeaksAsFastInBrightLightAndInShortSteps) {
    SensorTraits traits = plain(.01);
    traits.leak_hz = 2;  // .000002 in each step, beside a 9 of which rounding leaves .000001
    const auto events = watch(
        traits, 2.05, [](double) { return 9; }, 100);
    ASSERT_EQ(double(events.size()), 4 * kPixels);
    const auto times = times_by_pixel(events).begin()->second;
    for (std::size_t i = 1; i < times.size(); ++i)
        EXPECT_NEAR(double(times[i] - times[i - 1]), 500'000, 1000);
}

TEST(EventSensor, LeaksAsFastAfterDays) {
    SensorTraits traits = plain(.2);
    traits.leak_hz = .2;
    EventSensor sensor{traits, 4, 1, Random{7}};
    Array2<float> lux(1, 4);
    std::ranges::fill(lux.values(), 100.F);
    sensor.settle(lux, 1);
    constexpr int kSeconds = 10 * 86400;
    std::vector<Event> events;
    for (int s = 0; s < kSeconds; ++s) {
        if (s == kSeconds - 100) events.clear();
        sensor.step(from_us(s * 1'000'000LL), from_us((s + 1) * 1'000'000LL), lux, 1, events);
    }
    ASSERT_EQ(events.size(), 4 * 20U);
    for (std::size_t i = 4; i < events.size(); ++i)
        EXPECT_NEAR(double(to_us(events[i].t) - to_us(events[i - 4].t)), 5e6, 1000);
}

/// Of each pixel, in Hz, where nothing moves.
std::vector<double> leak_rates(const SensorTraits& traits) {
    std::vector<double> rates;
    for (const auto& [pixel, times] : times_by_pixel(watch(traits, 10, still, 10000)))
        rates.push_back(double(times.size()) / 10);
    return rates;
}

TEST(EventSensor, LeaksDifferentlyFromPixelToPixel) {
    SensorTraits traits = plain(.2);
    traits.leak_hz = 10;
    traits.leak_mismatch = .2;
    EXPECT_NEAR(moments(leak_rates(traits)).deviation, 2, .2);
}

TEST(EventSensor, LeaksAsFastWhateverAPixelsThresholdIs) {
    SensorTraits traits = plain(.2);
    traits.leak_hz = 10;
    traits.mismatch = .2;
    EXPECT_LT(moments(leak_rates(traits)).deviation, .2);
}

TEST(EventSensor, KeepsTheRefractoryTimeBetweenAPixelsEvents) {
    SensorTraits traits = plain(.01);
    traits.refractory_s = .003;
    traits.shot_hz = 50;
    traits.shot_lux = 1e9;
    const auto events = watch(traits, 1, [](double t) { return 3 * std::sin(20 * t); });
    EXPECT_GT(double(events.size()), 100 * kPixels);
    for (const auto& [pixel, times] : times_by_pixel(events))
        for (std::size_t i = 1; i < times.size(); ++i) ASSERT_GE(times[i] - times[i - 1], 2999);
}

TEST(EventSensor, ForgetsChangesDuringRefractoryTime) {
    SensorTraits traits = plain(.1);
    traits.refractory_s = .05;
    // .1 takes 100 ms; then 50 ms pass unseen: an event every 150 ms, whether a step is shorter
    // than that or longer.
    for (const int step_us : {1000, 20'000, 500'000, 3'000'000}) {
        const auto times = times_by_pixel(watch(
                                              traits, 3, [](double t) { return t; }, step_us))
                               .begin()
                               ->second;
        ASSERT_EQ(times.size(), 20u) << step_us;
        for (std::size_t i = 1; i < times.size(); ++i)
            EXPECT_NEAR(double(times[i] - times[i - 1]), 150000, 100) << step_us;
    }
}

TEST(EventSensor, HasAsManyHotPixelsAsAskedForAndTheyAlwaysFire) {
    SensorTraits traits = plain(.3);
    traits.hot_share = .01;
    traits.hot_hz = {50, 200};
    const auto times = times_by_pixel(watch(traits, 10, still));
    EXPECT_NEAR(double(times.size()), .01 * kPixels, 2);
    for (const auto& [pixel, list] : times) {
        EXPECT_GT(list.size(), 400u);
        EXPECT_LT(list.size(), 4400u);  // two may have met in one pixel
    }
}

TEST(EventSensor, HotPixelsBeginAtTimesOfTheirOwnAndMostFireOnAlone) {
    SensorTraits traits = plain(.3);
    traits.hot_share = .3;
    traits.hot_hz = {50, 50};
    const auto events = watch(traits, 2, still);
    int at_once = 0;
    const auto times = times_by_pixel(events);
    for (const auto& [pixel, list] : times) at_once += list.front() <= 1000;
    EXPECT_LT(at_once, double(times.size()) / 8) << "in a twentieth of their mean interval";
    EXPECT_NEAR(share_on(events), .6 + .4 * .5, .05);
}

TEST(EventSensor, KeepsTheRefractoryTimeOfHotPixelsToo) {
    SensorTraits traits = plain(.3);
    traits.hot_share = .05;
    traits.hot_hz = {400, 800};
    traits.refractory_s = .003;
    const auto times = times_by_pixel(watch(traits, 1, still, 10'000));
    EXPECT_GT(double(times.size()), .04 * kPixels);
    for (const auto& [pixel, list] : times) {
        EXPECT_NEAR(double(list.size()), 220, 60);  // r / (1 + .003 r)
        for (std::size_t i = 1; i < list.size(); ++i) ASSERT_GE(list[i] - list[i - 1], 2999);
    }
}

TEST(EventSensor, HotPixelsFireBetweenTheEventsOfTheLight) {
    SensorTraits traits = plain(.01);
    traits.refractory_s = .0005;
    const auto per_second = [&] {  // an event of the light each 5.5 ms
        const auto events = watch(
            traits, 4, [](double t) { return 5 + 2 * t; }, 10'000);
        for (const auto& [pixel, list] : times_by_pixel(events))
            for (std::size_t i = 1; i < list.size(); ++i) EXPECT_GE(list[i] - list[i - 1], 499);
        return double(events.size()) / kPixels / 4;
    };
    const double light = per_second();
    EXPECT_NEAR(light, 1 / .0055, 1);
    traits.hot_share = 1;
    traits.hot_hz = {100, 100};
    // .5 ms before and after the light's, and after others of their own, they do not; of a pixel
    // that was drawn twice the second comes from 200 Hz.
    EXPECT_NEAR(per_second() - light, 100 * (1 - 1 / 5.5) * (1 - .05), 6);
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
