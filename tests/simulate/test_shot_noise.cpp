// Noise of the simulated sensor: as often as asked for, back and forth, and nothing of the light
// lost.
#include "tests/simulate/watched_sensor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace eventide::watched_sensor {
namespace {

SensorTraits noisy(double hz, double lux) {
    SensorTraits traits = plain(.3);
    traits.shot_hz = hz;
    traits.shot_lux = lux;
    return traits;
}

std::vector<double> counts_of(const std::vector<Event>& events) {
    std::vector<double> counts(std::size_t(kPixels), 0.0);
    for (const Event& e : events) ++counts[std::size_t(e.y * kSide + e.x)];
    return counts;
}

std::map<int, std::vector<Polarity>> polarities_by_pixel(std::vector<Event> events) {
    std::ranges::sort(events, {}, &Event::t);
    std::map<int, std::vector<Polarity>> polarities;
    for (const Event& e : events) polarities[e.y * kSide + e.x].push_back(e.polarity);
    return polarities;
}

TEST(ShotNoise, ComesAsOftenAsAskedForAndFallsWithLight) {
    const auto rate = [&](double lux) {
        const auto events = watch(noisy(4, 50), 10, [&](double) { return std::log(lux); });
        EXPECT_NEAR(share_on(events), .5, .03);
        return moments(counts_of(events)).mean / 10;
    };
    EXPECT_NEAR(rate(.001), 4, .15);
    EXPECT_NEAR(rate(50), 2, .1);
    EXPECT_NEAR(rate(450), .4, .05);
}

TEST(ShotNoise, GoesBackAndForth) {
    const auto events = watch(noisy(20, 1e9), 5, still);
    double pairs = 0, opposite = 0;
    for (const auto& [pixel, list] : polarities_by_pixel(events)) {
        const auto on = std::ranges::count(list, Polarity::on);
        EXPECT_LE(std::abs(2 * on - std::ptrdiff_t(list.size())), 1);
        for (std::size_t i = 1; i < list.size(); ++i) {
            ++pairs;
            opposite += list[i] != list[i - 1];
        }
    }
    EXPECT_NEAR(opposite / pairs, .925, .02);  // camerashake_b: .94
}

TEST(ShotNoise, ReturnsOnceItsPixelCanFireAgain) {
    SensorTraits traits = noisy(20, 1e9);
    traits.shot_return_s = .004;
    traits.refractory_s = .01;  // most returns come too early
    const auto events = watch(traits, 5, still);
    EXPECT_GT(double(events.size()), 50 * kPixels);
    for (const auto& [pixel, list] : polarities_by_pixel(events)) {
        const auto on = std::ranges::count(list, Polarity::on);
        ASSERT_LE(std::abs(2 * on - std::ptrdiff_t(list.size())), 1) << pixel;
    }
}

TEST(ShotNoise, ReturnsAfterTheTimeAskedFor) {
    SensorTraits traits = noisy(.5, 1e9);  // so rare that hardly two swings meet
    traits.shot_return_s = .02;
    std::vector<double> gaps;
    for (const auto& [pixel, times] : times_by_pixel(watch(traits, 20, still)))
        for (std::size_t i = 1; i < times.size(); i += 2)
            gaps.push_back(double(times[i] - times[i - 1]) * 1e-6);
    EXPECT_NEAR(moments(gaps).mean, .02, .001);
    EXPECT_NEAR(moments(gaps).deviation, .02, .003);  // exponential
}

TEST(ShotNoise, DiffersBetweenPixelsByAsMuchAsAskedFor) {
    const auto spread = [](double mismatch) {
        SensorTraits traits = noisy(4, 1e9);
        traits.shot_mismatch = mismatch;
        const Moments m = moments(counts_of(watch(traits, 10, still)));
        EXPECT_NEAR(m.mean, 40, 4);
        return m.deviation * m.deviation / m.mean;
    };
    EXPECT_NEAR(spread(0), 2, .3);  // pairs: twice that of single events
    EXPECT_NEAR(spread(.9), 2 + 40 * (std::exp(.81) - 1), 20);
}

TEST(ShotNoise, TakesNothingOfTheLight) {
    // Light goes up by 5 thresholds and a half. What is counted is that, and at most one swing.
    SensorTraits traits = noisy(30, 1e9);
    traits.threshold_on = traits.threshold_off = .1;
    const auto events = watch(traits, 2, [](double t) { return 5 + .275 * t; });
    EXPECT_GT(double(events.size()), 50 * kPixels);
    for (const auto& [pixel, list] : polarities_by_pixel(events)) {
        const auto on = std::ranges::count(list, Polarity::on);
        ASSERT_NEAR(double(2 * on - std::ptrdiff_t(list.size())), 5, 1) << pixel;
    }
}

/// Events per pixel and second of light that grows, which fires every 5.5 ms. None is nearer to
/// another of its pixel than the refractory time.
double rate_before_growing_light(double shot_hz, int step_us) {
    SensorTraits traits = noisy(shot_hz, 1e9);
    traits.threshold_on = .01;
    traits.refractory_s = .0005;
    const auto events = watch(
        traits, 4, [](double t) { return 5 + 2 * t; }, step_us);
    for (const auto& [pixel, times] : times_by_pixel(events))
        for (std::size_t i = 1; i < times.size(); ++i) EXPECT_GE(times[i] - times[i - 1], 499);
    return double(events.size()) / kPixels / 4;
}

TEST(ShotNoise, ComesBetweenTheEventsOfTheLightHoweverLongAStepIs) {
    for (const int step_us : {200, 2000, 10'000}) {
        const double light = rate_before_growing_light(0, step_us);
        EXPECT_NEAR(light, 1 / .0055, 1);
        // A sixth is nearer than .5 ms to an event of the light, and less begins while a swing
        // lasts.
        const double noise = rate_before_growing_light(20, step_us) - light;
        EXPECT_NEAR(noise, 16.5, 2) << step_us;
    }
}

}  // namespace
}  // namespace eventide::watched_sensor
