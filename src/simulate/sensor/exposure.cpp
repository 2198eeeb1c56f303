// Metering on a coarse grid, and development of whole images.
#include "src/simulate/sensor/exposure.h"

#include "src/core/simd4.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace eventide {

namespace {

constexpr double kMeterEverySeconds = .02;
constexpr int kMeterPoints = 16;  // in each direction

std::vector<float> metered(const Array2<float>& light, double light_gain, double gamma) {
    std::vector<float> signal;
    for (int j = 0; j < kMeterPoints; ++j)
        for (int i = 0; i < kMeterPoints; ++i) {
            const float v = light((2 * j + 1) * light.height() / (2 * kMeterPoints),
                                  (2 * i + 1) * light.width() / (2 * kMeterPoints));
            signal.push_back(float(std::pow(double(v) * light_gain, 1 / gamma)));
        }
    return signal;
}

double mean_of(const std::vector<float>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

}  // namespace

Exposure::Exposure(const SceneSettings& settings, Random random) {
    deviation_ = random.uniform(settings.target_deviation);
    white_ =
        random.chance(settings.target_white_below_one) ? random.uniform(settings.target_white) : 1;
    // A sensor that saturates early cannot be bright: at most six tenths of its range.
    mean_ = std::min(random.uniform(settings.target_mean), .6 * white_);
    black_range_ = settings.target_black;
    gamma_ = random.uniform(settings.target_gamma);
    fixed_ = random.chance(settings.exposure_fixed);
    lag_s_ = random.log_uniform(settings.exposure_lag_s);
}

/// The gain that gives the wanted mean after clipping, found by repeated correction.
double Exposure::gain_for_mean(const std::vector<float>& signal, double gain) const {
    for (int i = 0; i < 8; ++i) {
        double sum = 0;
        for (const float v : signal) sum += std::clamp(black_ + gain * double(v), 0.0, white_);
        const double mean = sum / double(signal.size());
        gain *= std::clamp((mean_ - black_) / std::max(mean - black_, 1e-3), .5, 2.0);
    }
    return gain;
}

bool Exposure::due(double t_s) const {
    return history_.empty() || (!fixed_ && t_s >= history_.back().t_s + kMeterEverySeconds);
}

void Exposure::meter(double t_s, const Array2<float>& light, double light_gain) {
    if (!due(t_s)) return;
    const std::vector<float> signal = metered(light, light_gain, gamma_);
    const double mean = mean_of(signal);
    if (history_.empty()) {
        double square = 0;
        for (const float v : signal) square += (double(v) - mean) * (double(v) - mean);
        const double deviation = std::sqrt(square / double(signal.size()));
        black_ = mean_ - deviation_ / std::max(deviation, 1e-6 * mean) * mean;
        const double most = std::min(black_range_.high, .5 * mean_);
        black_ = std::clamp(black_, std::min(black_range_.low, most), most);
        const double gain = gain_for_mean(signal, (mean_ - black_) / mean);
        history_.push_back({t_s, std::log(gain)});
        return;
    }
    const Setting last = history_.back();
    const double wanted = std::log(gain_for_mean(signal, (mean_ - black_) / mean));
    const double share = 1 - std::exp(-(t_s - last.t_s) / lag_s_);
    history_.push_back({t_s, last.log_gain + share * (wanted - last.log_gain)});
}

void Exposure::forget(double before_s) {
    while (history_.size() > 2 && history_[1].t_s <= before_s) history_.pop_front();
}

void Exposure::develop(double t_s, double light_gain, Array2<float>& image) const {
    using namespace lanes;
    // The gain of the latest metering before t: a camera changes it between images.
    const auto after = std::ranges::upper_bound(history_, t_s, {}, &Setting::t_s);
    const Setting& now = after == history_.begin() ? *after : *std::prev(after);
    const float power = float(1 / gamma_);
    const float shift = float(now.log_gain + std::log(light_gain) / gamma_);
    const auto black = float(black_), white = float(white_);
    const auto one = [&](F4 v) {
        return clamp(black + lanes::exp(lanes::log(v) * power + shift), 0, white);
    };
    const std::span<float> values = image.values();
    std::size_t i = 0;
    for (; i + 4 <= values.size(); i += 4) store(values.data() + i, one(load(values.data() + i)));
    for (; i < values.size(); ++i) values[i] = one(splat(values[i]))[0];
}

}  // namespace eventide
