#include "src/simulate/sensor/shot_noise.h"

#include <algorithm>
#include <cmath>

namespace eventide {

namespace {

/// A pixel whose light is near its upper threshold swings up time and again.
constexpr double kSameWayAgain = .85;

Polarity opposite(Polarity p) {
    return p == Polarity::on ? Polarity::off : Polarity::on;
}

}  // namespace

ShotNoise::ShotNoise(const SensorTraits& traits, std::size_t pixels, Random random)
    : lux_(traits.shot_lux), return_s_(traits.shot_return_s), random_(random), next_s_(1e300) {
    if (traits.shot_hz <= 0) return;
    const double s = traits.shot_mismatch;
    double total = 0;
    for (std::size_t i = 0; i < pixels; ++i) {
        total += traits.shot_hz / 2 * std::exp(s * random_.normal() - s * s / 2);
        up_to_.push_back(total);
        first_.push_back(random_.chance(.5) ? Polarity::on : Polarity::off);
    }
    swings_.assign(pixels, false);
    next_s_ = random_.exponential() / total;
}

void ShotNoise::until(double end_s, const Light& light, const Fire& fire) {
    for (;;) {
        const double back_s = returns_.empty() ? 1e300 : returns_.top().t_s;
        if (std::min(back_s, next_s_) > end_s) return;
        if (back_s < next_s_)
            end_swing(fire);
        else
            begin_swing(light, fire);
    }
}

/// Candidates come at the dark rate over the whole sensor; one in the light is kept less often.
void ShotNoise::begin_swing(const Light& light, const Fire& fire) {
    const double t_s = next_s_;
    next_s_ += random_.exponential() / up_to_.back();
    const auto place = std::ranges::lower_bound(up_to_, random_.uniform() * up_to_.back());
    const auto pixel = std::min(std::size_t(place - up_to_.begin()), up_to_.size() - 1);
    const bool kept = random_.chance(lux_ / (lux_ + light(pixel)));
    const Polarity polarity =
        random_.chance(kSameWayAgain) ? first_[pixel] : opposite(first_[pixel]);
    if (!kept || swings_[pixel] || !fire(pixel, t_s, polarity)) return;
    first_[pixel] = polarity;
    swings_[pixel] = true;
    returns_.push(
        {t_s + return_s_ * random_.exponential(), std::uint32_t(pixel), opposite(polarity)});
}

void ShotNoise::end_swing(const Fire& fire) {
    Return back = returns_.top();
    returns_.pop();
    if (fire(back.pixel, back.t_s, back.polarity)) {
        swings_[back.pixel] = false;
        return;
    }
    back.t_s += return_s_ * random_.exponential();
    returns_.push(back);
}

}  // namespace eventide
