// A textured scene that moves and then stands still.
#include "apps/cli/stress/still_scene.h"

#include <algorithm>
#include <chrono>
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

/// Stripes and spots of 10 to 80 px, of 20 to 180 lux.
double light(double x, double y) {
    constexpr double kTurn = 2 * std::numbers::pi;
    const double coarse = std::sin(kTurn * (x + .3 * y) / 80) * std::cos(kTurn * y / 66);
    const double fine = std::sin(kTurn * (x - y) / 26) + std::sin(kTurn * (x + 2 * y) / 36);
    const bool spot = std::fmod(std::abs(x) + 100, 28) < 12 && std::fmod(y + 100, 20) < 10;
    return 60 * std::exp(.5 * coarse + .25 * fine + (spot ? .4 : 0));
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

/// Round in a circle of 6 px, once in three seconds; every edge is seen to move. In the last second
/// of motion it comes to rest.
void StillScene::draw(double t_s) {
    const double slowing = std::max(0.0, t_s + 1 - std::chrono::duration<double>(moving_).count());
    const double turned = t_s - slowing * slowing / 2;
    const double angle = 2 * std::numbers::pi * turned / 3;
    const double dx = 6 * std::cos(angle), dy = 6 * std::sin(angle);
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
