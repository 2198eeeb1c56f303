// What happens to one number at a time, and the recurrent unit made of it.
#pragma once

#include "src/kernels/mask.h"
#include "src/kernels/plain/conv.h"

#include <cmath>

namespace eventide::plain {

template <typename T>
T relu(T v) {
    return v > 0 ? v : T(0);
}
template <typename T>
T elu(T v) {
    return v > 0 ? v : std::expm1(v);
}
template <typename T>
T sigmoid(T v) {
    return 1 / (1 + std::exp(-v));
}
/// T(v) of docs/model.md: keeps a hot pixel's counts from swamping the network.
template <typename T>
T compress(T v) {
    return std::copysign(std::log1p(std::abs(v)), v);
}

template <typename T, typename Function>
Array3<T> each(Array3<T> map, Function function) {
    for (T& v : map.values()) v = function(v);
    return map;
}
template <typename T, typename Function>
Array3<T> each(Array3<T> a, const Array3<T>& b, Function function) {
    for (std::size_t i = 0; i < a.values().size(); ++i)
        a.values()[i] = function(a.values()[i], b.values()[i]);
    return a;
}

template <typename T>
struct GruWeights {
    ConvWeights<T> gates;      ///< [2 C]: update, then reset; [C] without a reset gate
    ConvWeights<T> candidate;  ///< [C]
};

/// h <- h + m u (c - h). Where the mask is 0, h is not touched.
///
///     [u; r] = sigmoid(gates * [a; h]),  c = tanh(candidate * [a; r h])
///
/// Without a reset gate r = 1.
template <typename T>
void gru(const GruWeights<T>& weights, const Array3<T>& a, const Mask& mask, Array3<T>& h) {
    const Array3<T> gates = each(conv(weights.gates, join<T>({&a, &h})), sigmoid<T>);
    const int channels = h.channels();
    const bool resets = weights.gates.out == 2 * channels;
    Array3<T> reset = h;
    for (int y = 0; resets && y < h.height(); ++y)
        for (int x = 0; x < h.width(); ++x)
            for (int c = 0; c < channels; ++c) reset(y, x, c) *= gates(y, x, channels + c);
    const Array3<T> candidate =
        each(conv(weights.candidate, join<T>({&a, &reset})), [](T v) { return std::tanh(v); });
    for (int y = 0; y < h.height(); ++y)
        for (int x = 0; x < h.width(); ++x) {
            if (mask(y, x) == 0) continue;
            for (int c = 0; c < channels; ++c)
                h(y, x, c) += gates(y, x, c) * (candidate(y, x, c) - h(y, x, c));
        }
}

template <typename T>
struct NormWeights {
    std::vector<T> alpha, gamma, beta;  ///< [C]
};

/// InstanceNorm2d+ (docs/model.md). One channel alone has no spread of means: its alpha term is 0.
/// norm(x)_c = gamma_c ((x_c - mean_c) / sqrt(variance_c + 1e-5)
///                      + alpha_c (mean_c - grand) / sqrt(spread + 1e-5)) + beta_c
/// Statistics are double for every T: sums over an image would lose a float's last digits.
template <typename T>
Array3<T> norm(const NormWeights<T>& weights, Array3<T> map) {
    const auto channels = std::size_t(map.channels());
    const double pixels = double(map.values().size()) / double(channels);
    std::vector<double> mean(channels), variance(channels);
    for (std::size_t i = 0; i < map.values().size(); ++i)
        mean[i % channels] += double(map.values()[i]) / pixels;
    for (std::size_t i = 0; i < map.values().size(); ++i) {
        const double d = double(map.values()[i]) - mean[i % channels];
        variance[i % channels] += d * d / pixels;
    }
    double grand = 0, spread = 0;
    for (const double m : mean) grand += m / double(channels);
    for (const double m : mean) spread += (m - grand) * (m - grand);
    if (channels > 1) spread /= double(channels - 1);
    constexpr double kEpsilon = 1e-5;
    for (std::size_t i = 0; i < map.values().size(); ++i) {
        const std::size_t c = i % channels;
        const double own = (double(map.values()[i]) - mean[c]) / std::sqrt(variance[c] + kEpsilon);
        const double shared = (mean[c] - grand) / std::sqrt(spread + kEpsilon);
        map.values()[i] = T(double(weights.gamma[c]) * (own + double(weights.alpha[c]) * shared) +
                            double(weights.beta[c]));
    }
    return map;
}

}  // namespace eventide::plain
