// Leaks, refractory times and hot pixels of the simulated sensor, by their statistics.
#include "tests/simulate/watched_sensor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace eventide {
namespace {

using namespace watched_sensor;

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

}  // namespace
}  // namespace eventide
