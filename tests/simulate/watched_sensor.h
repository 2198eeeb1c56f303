// A small simulated sensor before light that changes everywhere alike, and statistics of its
// events.
#pragma once

#include "src/simulate/sensor/event_sensor.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <vector>

namespace eventide::watched_sensor {

inline constexpr int kSide = 32;
inline constexpr double kPixels = kSide * kSide;

inline SensorTraits plain(double threshold) {
    SensorTraits traits;
    traits.threshold_on = traits.threshold_off = threshold;
    return traits;
}

/// Events of a sensor whose pixels all see exp(log_lux(t)), in steps of `step_us`.
inline std::vector<Event> watch(const SensorTraits& traits, double seconds,
                                const std::function<double(double)>& log_lux, int step_us = 1000) {
    EventSensor sensor{traits, kSide, kSide, Random{7}};
    Array2<float> lux(kSide, kSide);
    const auto set = [&](double t) {
        std::ranges::fill(lux.values(), float(std::exp(log_lux(t))));
    };
    set(0);
    sensor.settle(lux, 1);
    std::vector<Event> events;
    const int steps = int(std::lround(seconds * 1e6 / step_us));
    for (int i = 0; i < steps; ++i) {
        set((i + 1) * step_us * 1e-6);
        sensor.step(from_us(std::int64_t(i) * step_us), from_us(std::int64_t(i + 1) * step_us), lux,
                    1, events);
    }
    return events;
}

inline double still(double) {
    return std::log(100.0);
}

inline std::map<int, std::vector<std::int64_t>> times_by_pixel(const std::vector<Event>& events) {
    std::map<int, std::vector<std::int64_t>> times;
    for (const Event& e : events) times[e.y * kSide + e.x].push_back(to_us(e.t));
    for (auto& [pixel, list] : times) std::ranges::sort(list);
    return times;
}

inline double share_on(const std::vector<Event>& events) {
    return double(std::ranges::count(events, Polarity::on, &Event::polarity)) /
           double(events.size());
}

struct Moments {
    double mean = 0, deviation = 0;
};
inline Moments moments(const std::vector<double>& values) {
    Moments m;
    for (const double v : values) m.mean += v / double(values.size());
    for (const double v : values)
        m.deviation += (v - m.mean) * (v - m.mean) / double(values.size());
    m.deviation = std::sqrt(m.deviation);
    return m;
}

}  // namespace eventide::watched_sensor
