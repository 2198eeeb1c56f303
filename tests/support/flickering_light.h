// Events of a scene in the light of a lamp that flickers.
#pragma once

#include "src/core/event.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

namespace eventide::test {

struct FlickeringLight {
    int width = 32, height = 24;
    double hz = 300;
    double seconds = .3;
    double share = .5;       ///< of the cycles that a pixel sees
    double spread_us = 250;  ///< of an event about its time in the cycle
};

/// Each pixel fires on in one half of a cycle and off in the other, or not at all in this cycle.
inline std::vector<Event> lamp_events(const FlickeringLight& light) {
    std::mt19937 random{5};
    std::uniform_real_distribution<double> chance{0, 1};
    std::normal_distribution<double> spread{0, light.spread_us};
    const double period = 1e6 / light.hz;
    std::vector<Event> events;
    for (int y = 0; y < light.height; ++y)
        for (int x = 0; x < light.width; ++x)
            for (int cycle = 1; cycle * period < light.seconds * 1e6; ++cycle) {
                if (chance(random) >= light.share) continue;
                const auto at = [&](double part) {
                    const double off = std::clamp(spread(random), -.2 * period, .2 * period);
                    return from_us(std::int64_t((cycle + part) * period + off));
                };
                events.push_back({at(0), std::uint16_t(x), std::uint16_t(y), Polarity::on});
                events.push_back({at(.5), std::uint16_t(x), std::uint16_t(y), Polarity::off});
            }
    std::ranges::stable_sort(events, {}, &Event::t);
    return events;
}

/// A bright bar that moves from left to right, now and then: a pixel brightens as it comes and
/// darkens as it leaves.
inline std::vector<Event> bar_events(int width, int height, double seconds, double px_per_second) {
    std::mt19937 random{6};
    std::normal_distribution<double> spread{0, 300};
    constexpr double kBar = 8;  // px
    std::vector<Event> events;
    const double step = (width + kBar) / px_per_second;
    std::uniform_real_distribution<double> pause{0, step};
    for (double begin = 0; begin < seconds; begin += step + pause(random))
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                for (const bool on : {true, false}) {
                    const double s = begin + (x + (on ? 0 : kBar)) / px_per_second;
                    if (s >= seconds) continue;
                    const auto us = std::int64_t(1e6 * s + 1000 + spread(random));
                    events.push_back({from_us(std::max<std::int64_t>(us, 1)), std::uint16_t(x),
                                      std::uint16_t(y), on ? Polarity::on : Polarity::off});
                }
    std::ranges::stable_sort(events, {}, &Event::t);
    return events;
}

/// A wheel of bright spokes, as wide as what is between them: each pixel brightens as a spoke
/// comes, evenly, but each at a time of its own.
struct Wheel {
    int width = 32, height = 24;
    double x = 16, y = 12;  ///< of its hub, px
    int spokes = 3;
    double hz = 300;  ///< spokes that pass a pixel in a second
    double seconds = .3;
    double spread_us = 100;
};

inline std::vector<Event> wheel_events(const Wheel& wheel) {
    std::mt19937 random{7};
    std::normal_distribution<double> spread{0, wheel.spread_us};
    const double period = 1e6 / wheel.hz;
    std::vector<Event> events;
    for (int y = 0; y < wheel.height; ++y)
        for (int x = 0; x < wheel.width; ++x) {
            const double turn =
                std::atan2(y + .5 - wheel.y, x + .5 - wheel.x) / (2 * std::numbers::pi);
            const double phase = turn * wheel.spokes - std::floor(turn * wheel.spokes);
            // A spoke's beginning and its end, half a period apart.
            for (int half = 1; (phase + .5 * half) * period < wheel.seconds * 1e6; ++half) {
                const auto us = std::int64_t((phase + .5 * half) * period + spread(random));
                events.push_back({from_us(std::max<std::int64_t>(us, 1)), std::uint16_t(x),
                                  std::uint16_t(y), half % 2 == 0 ? Polarity::on : Polarity::off});
            }
        }
    std::ranges::stable_sort(events, {}, &Event::t);
    return events;
}

inline std::vector<Event> merged(const std::vector<Event>& a, const std::vector<Event>& b) {
    std::vector<Event> all;
    std::ranges::merge(a, b, std::back_inserter(all), {}, &Event::t, &Event::t);
    return all;
}

}  // namespace eventide::test
