// A textured scene that moves and then stands still.
#include "src/app/stress/still_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace eventide::stress {
namespace {

/// Middling values of what networks are trained on (SensorSettings): some 0.1 leak events and one
/// of shot noise per second and pixel, one pixel in a thousand hot.
SensorTraits traits() {
    SensorTraits t;
    t.threshold_on = t.threshold_off = .2;
    t.mismatch = .05;
    t.threshold_min = .01;
    t.random_phase = true;
    t.bandwidth_hz = 1000;
    t.bandwidth_hz_per_lux = 20;
    t.refractory_s = .0005;
    t.leak_hz = .1;
    t.leak_mismatch = .2;
    t.shot_hz = 1;
    t.shot_lux = 100;
    t.shot_return_s = .01;
    t.shot_mismatch = .6;
    t.hot_share = .001;
    t.hot_hz = {5, 1000};
    return t;
}

/// Stripes and spots of 6 to 40 px, of 20 to 180 lux.
double light(double x, double y) {
    constexpr double kTurn = 2 * std::numbers::pi;
    const double coarse = std::sin(kTurn * (x + .3 * y) / 40) * std::cos(kTurn * y / 33);
    const double fine = std::sin(kTurn * (x - y) / 11) + std::sin(kTurn * (x + 2 * y) / 17);
    const double spot = std::fmod(std::abs(x) + 100, 14) < 6 && std::fmod(y + 100, 10) < 5 ? 1 : 0;
    return 60 * std::exp(.5 * coarse + .25 * fine + .4 * spot);
}

}  // namespace

StillScene::StillScene(int width, int height, SensorDuration moving)
    : width_{width},
      height_{height},
      moving_{moving},
      lux_{height, width},
      sensor_{traits(), width, height, Random{7}} {
    draw(0);
    sensor_.settle(lux_, 1);
}

/// Round in a circle of 8 px, once a second: every edge is seen to move.
void StillScene::draw(double t_s) {
    const double angle = 2 * std::numbers::pi * t_s;
    const double dx = 8 * std::cos(angle), dy = 8 * std::sin(angle);
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) lux_(y, x) = float(light(x + dx, y + dy));
}

void StillScene::advance(std::vector<Event>& events) {
    const bool moves = now_ < SensorTime{moving_};
    const SensorTime end = now_ + (moves ? SensorDuration{10'000} : SensorDuration{100'000});
    if (moves) draw(double(to_us(end)) * 1e-6);
    const std::size_t before = events.size();
    sensor_.step(now_, end, lux_, 1, events);
    std::ranges::sort(events.begin() + std::ptrdiff_t(before), events.end(), {}, &Event::t);
    now_ = end;
}

}  // namespace eventide::stress
