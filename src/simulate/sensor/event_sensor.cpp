// Low-pass, thresholds, refractory time, leak, shot noise and hot pixels.
#include "src/simulate/sensor/event_sensor.h"

#include "src/core/simd4.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace eventide {

namespace {

/// A reference no value can be near: the pixel is in its refractory time and takes its reference
/// when that ends.
constexpr float kHeld = 1e30f;

std::size_t whole_lanes(std::size_t n) {
    return (n + 3) & ~std::size_t(3);
}

/// Time constant of the photoreceptor: what its bandwidth in bright and in dim light give together.
struct Photoreceptor {
    float tau_bright = 0;     // s
    float tau_per_light = 0;  // s lux

    explicit Photoreceptor(const SensorTraits& t) {
        const auto tau = [](double hz) {
            return hz > 0 ? float(1 / (2 * std::numbers::pi * hz)) : 0.f;
        };
        tau_bright = tau(t.bandwidth_hz);
        tau_per_light = tau(t.bandwidth_hz_per_lux);
    }
    bool instant() const { return tau_bright == 0 && tau_per_light == 0; }

    /// Where `value` has gone after `dt` in which ln light went straight from one value to another,
    /// `light` at the end.
    lanes::F4 follow(lanes::F4 value, lanes::F4 from, lanes::F4 to, lanes::F4 light,
                     float dt) const {
        const lanes::F4 r = dt / (tau_bright + tau_per_light / light);
        // Within .012 kept is e^-r; q kept is (1 - e^-r) / r, without the difference of two
        // numbers that are nearly 1.
        const lanes::F4 q = 1.f + r * (.5f + r * (1.f / 6 + r * (1.f / 24)));
        const lanes::F4 kept = 1.f / (1.f + r * q);
        return to + kept * (value - from - q * (to - from));
    }
};

/// How long leaks are added up before the references take them over: what leaks in a step may be
/// less than a rounding of a float.
constexpr double kLeakTakenSeconds = 1;

}  // namespace

struct EventSensor::Step {
    SensorTime begin;
    double begin_s, end_s, seconds;
    std::int64_t us;
    std::size_t first;  // how many events there were before
};

EventSensor::EventSensor(const SensorTraits& traits, int width, int height, Random random)
    : traits_(traits),
      width_(width),
      height_(height),
      pixels_(std::size_t(width) * std::size_t(height)),
      random_(random),
      noise_(traits, pixels_, random_.fork()) {
    const std::size_t n = whole_lanes(pixels_);
    for (std::vector<float>* values : {&ln_light_, &now_, &before_, &reference_, &leak_})
        values->assign(n, 0);
    on_.assign(n, kHeld);  // what pads the last lanes never fires
    off_.assign(n, kHeld);
    ready_s_.assign(n, -1);
    for (std::size_t i = 0; i < pixels_; ++i) {
        const auto vary = [&](double mean, double share) {
            return mean * (1 + share * random_.normal());
        };
        on_[i] = float(std::max(traits.threshold_min, vary(traits.threshold_on, traits.mismatch)));
        off_[i] =
            float(std::max(traits.threshold_min, vary(traits.threshold_off, traits.mismatch)));
        const double rate = std::max(0.0, vary(traits.leak_hz, traits.leak_mismatch));
        leak_[i] = float(rate * double(on_[i]));
    }
    const auto hot = std::size_t(traits.hot_share * double(pixels_) + random_.uniform());
    for (std::size_t i = 0; i < hot; ++i) {
        HotPixel pixel{.pixel = std::uint32_t(random_.uniform() * double(pixels_)),
                       .rate_hz = random_.log_uniform(traits.hot_hz)};
        pixel.on_share = random_.chance(.6) ? 1 : random_.uniform();
        pixel.next_s = random_.exponential() / pixel.rate_hz;
        hot_.push_back(pixel);
    }
}

void EventSensor::settle(const Array2<float>& lux, double gain) {
    for (std::size_t i = 0; i < pixels_; ++i) {
        now_[i] = std::log(lux.values()[i] * float(gain) + float(traits_.dark_lux));
        ln_light_[i] = now_[i];
        const double phase = traits_.random_phase ? random_.uniform() : 0;
        reference_[i] = now_[i] + float(phase) * off_[i];
        if (random_.chance(.5)) reference_[i] = now_[i] - float(phase) * on_[i];
    }
}

void EventSensor::step(SensorTime begin, SensorTime end, const Array2<float>& lux, double gain,
                       std::vector<Event>& events) {
    using namespace lanes;
    const Step step{.begin = begin,
                    .begin_s = double(to_us(begin)) * 1e-6,
                    .end_s = double(to_us(end)) * 1e-6,
                    .seconds = double((end - begin).count()) * 1e-6,
                    .us = (end - begin).count(),
                    .first = events.size()};
    const Photoreceptor receptor{traits_};
    const auto dt = float(step.seconds), light_gain = float(gain), dark = float(traits_.dark_lux);
    for (HotPixel& hot : hot_) hot.ready_s = ready_s_[hot.pixel];
    lit_.clear();
    std::swap(now_, before_);
    leaking_s_ += step.seconds;
    const auto leaking = float(leaking_s_);

    const auto block = [&](std::size_t i, F4 light) {
        light = light * light_gain + dark;
        const F4 before = load(&before_[i]);
        F4 now = log(light);
        if (!receptor.instant()) {
            const F4 lit_before = load(&ln_light_[i]);
            store(&ln_light_[i], now);
            now = receptor.follow(before, lit_before, now, light, dt);
        }
        store(&now_[i], now);
        const F4 change = now - (load(&reference_[i]) - load(&leak_[i]) * leaking);
        const I4 fires = (change >= load(&on_[i])) | (change <= -load(&off_[i]));
        if (!any(fires)) return;
        for (std::size_t lane = 0; lane < 4; ++lane)
            if (fires[lane]) cross(step, i + lane, events);
    };
    const std::span<const float> light = lux.values();
    std::size_t i = 0;
    for (; i + 4 <= pixels_; i += 4) block(i, load(light.data() + i));
    if (i < pixels_) {
        F4 rest = splat(1.f);
        for (std::size_t lane = 0; i + lane < pixels_; ++lane) rest[lane] = light[i + lane];
        block(i, rest);
    }
    if (leaking_s_ >= kLeakTakenSeconds) take_leaks();
    add_shot_noise(step, light, gain, events);
    add_hot_pixels(step, events);
}

void EventSensor::take_leaks() {
    for (std::size_t i = 0; i < pixels_; ++i) reference_[i] -= leak_[i] * float(leaking_s_);
    leaking_s_ = 0;
}

/// All crossings of one pixel in one step. A leak lowers the reference steadily, which is the same
/// as a value that rises so much faster: in that view the reference stands still.
void EventSensor::cross(const Step& step, std::size_t pixel, std::vector<Event>& events) {
    const double v0 = double(before_[pixel]) - double(leak_[pixel]) * step.seconds;
    const double v1 = double(now_[pixel]), slope = v1 - v0;
    const double on = double(on_[pixel]), off = double(off_[pixel]);
    const double leaked = double(leak_[pixel]) * leaking_s_;
    double reference = double(reference_[pixel]) - leaked, share = 0;
    if (ready_s_[pixel] > step.begin_s) {
        if (ready_s_[pixel] >= step.end_s) return;
        share = (ready_s_[pixel] - step.begin_s) / step.seconds;
    }
    if (reference_[pixel] == kHeld) reference = v0 + slope * share;
    Lit lit{std::uint32_t(pixel), ready_s_[pixel], events.size(), events.size()};
    for (int n = 0;; ++n) {
        const bool rises = v1 >= reference + on;
        if (!rises && v1 > reference - off) break;
        if (n == kMaxPerStep) {
            reference = v1;
            break;
        }
        reference += rises ? on : -off;
        if (slope != 0) share = std::clamp((reference - v0) / slope, share, 1.0);
        events.push_back(event(step, pixel, share, rises ? Polarity::on : Polarity::off));
        if (traits_.refractory_s <= 0) continue;
        ready_s_[pixel] = step.begin_s + share * step.seconds + traits_.refractory_s;
        if (ready_s_[pixel] >= step.end_s) {
            reference = double(kHeld);
            break;
        }
        share = (ready_s_[pixel] - step.begin_s) / step.seconds;
        reference = v0 + slope * share;
    }
    reference_[pixel] = float(reference + leaked);
    lit.end = events.size();
    if (lit.end > lit.begin) lit_.push_back(lit);
}

/// The light's own events go on from the reference they had: noise swings about the light and takes
/// nothing of it. A noise event only keeps its pixel busy, like any other. Events of the light in
/// the same step are there already, also those that are later.
void EventSensor::add_shot_noise(const Step& step, std::span<const float> lux, double gain,
                                 std::vector<Event>& events) {
    const auto fire = [&](std::size_t pixel, double t_s, Polarity polarity) {
        const Event fired = event(step, pixel, (t_s - step.begin_s) / step.seconds, polarity);
        const auto lit = std::ranges::lower_bound(lit_, pixel, {}, &Lit::pixel);
        const bool is_lit = lit != lit_.end() && lit->pixel == pixel;
        double& ready_s = is_lit ? lit->ready_s : ready_s_[pixel];
        if (t_s < ready_s) return false;
        if (is_lit && !is_free(fired, std::span{events}.subspan(lit->begin, lit->end - lit->begin)))
            return false;
        events.push_back(fired);
        ready_s = t_s + traits_.refractory_s;
        ready_s_[pixel] = std::max(ready_s_[pixel], ready_s);
        return true;
    };
    noise_.until(
        step.end_s, [&](std::size_t pixel) { return double(lux[pixel]) * gain; }, fire);
}

/// Also before other events of the same step.
void EventSensor::add_hot_pixels(const Step& step, std::vector<Event>& events) {
    for (HotPixel& hot : hot_) {
        double& ready_s = ready_s_[hot.pixel];
        for (; hot.next_s <= step.end_s; hot.next_s += random_.exponential() / hot.rate_hz) {
            const double share = (hot.next_s - step.begin_s) / step.seconds;
            const Polarity polarity = random_.chance(hot.on_share) ? Polarity::on : Polarity::off;
            const Event fired = event(step, hot.pixel, share, polarity);
            if (hot.next_s < ready_s && (hot.next_s < hot.ready_s ||
                                         !is_free(fired, std::span{events}.subspan(step.first))))
                continue;
            events.push_back(fired);
            ready_s = std::max(ready_s, hot.next_s + traits_.refractory_s);
        }
    }
}

/// Whether none of the others of its pixel is nearer than the refractory time.
bool EventSensor::is_free(const Event& fired, std::span<const Event> others) const {
    return std::ranges::none_of(others, [&](const Event& other) {
        const double apart_us = std::abs(double((other.t - fired.t).count()));
        return other.x == fired.x && other.y == fired.y && apart_us < 1e6 * traits_.refractory_s;
    });
}

/// `share` of the step; times are rounded up, so that they lie in (begin, end].
Event EventSensor::event(const Step& step, std::size_t pixel, double share,
                         Polarity polarity) const {
    const auto us =
        std::clamp<std::int64_t>(std::int64_t(std::ceil(share * double(step.us))), 1, step.us);
    const std::size_t width = std::size_t(width_);
    return {step.begin + SensorDuration{us}, std::uint16_t(pixel % width),
            std::uint16_t(pixel / width), polarity};
}

}  // namespace eventide
