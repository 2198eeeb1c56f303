// The implicit decoder for float and double, with layer 1 computed once a latent sample, not once a
// query.
#pragma once

#include "src/model/model_file.h"
#include "src/model/render/sampling.h"
#include "src/model/render/still_pixels.h"
#include "src/nn/load_weights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace eventide::plain {

/// z_{k-2} .. z_{k+2}; null where unknown, which reads as zeros. Without a z_{k-1} no live edge
/// fades.
template <typename T>
using Codes = std::array<const Array3<T>*, 5>;

template <typename T>
struct RenderedFrame {
    Array2<T> intensity, sigma;
};

template <typename T>
class MlpRenderer {
public:
    explicit MlpRenderer(const Model& model) : config_(model.config) {
        for (std::size_t i = 0; i <= config_.mlp.size(); ++i) {
            const std::string name = "renderer.mlp." + std::to_string(i);
            const auto& shape = model.weights.at(name + ".weight").shape;
            layers_.push_back({int(shape[0]), int(shape[1]),
                               vector_of<T>(model.weights, name + ".weight"),
                               vector_of<T>(model.weights, name + ".bias")});
        }
    }

    /// docs/model.md, "Renderer"; the linear part of layer 1 that reads codes is a convolution of
    /// the latent maps, made once.
    RenderedFrame<T> render(const Codes<T>& codes, double fraction, const FrameGeometry& geometry,
                            SigmaRule rule) const {
        const bool fades = config_.live_edge == LiveEdge::fade && codes[1] != nullptr;
        const AxisSamples t = sample_time(fraction, codes[3] != nullptr, fades);
        FirstLayers first_layers;
        for (std::size_t n = 0; n < 2; ++n)
            if (t.weight[n] != 0) first_layers[n] = first_layer_of(codes, t.index + int(n));
        const int stride = config_.latent_stride;
        const AxisSamples still_t = sample_still_time(t, codes[3] != nullptr, fades);
        const Array2<std::uint8_t> still = still_pixels(config_, codes, t, still_t, geometry);
        RenderedFrame<T> out{{geometry.part_height, geometry.part_width},
                             {geometry.part_height, geometry.part_width}};
        for (int row = 0; row < geometry.part_height; ++row) {
            const AxisSamples y = sample_axis(geometry.y + row, geometry.height,
                                              geometry.sensor_height, stride, config_.blend);
            for (int column = 0; column < geometry.part_width; ++column) {
                const AxisSamples x = sample_axis(geometry.x + column, geometry.width,
                                                  geometry.sensor_width, stride, config_.blend);
                const Pixel pixel =
                    blend(first_layers, still(row, column) != 0 ? still_t : t, y, x, rule);
                out.intensity(row, column) = pixel.intensity;
                out.sigma(row, column) = pixel.sigma;
            }
        }
        return out;
    }

private:
    struct Layer {
        int out, in;
        std::vector<T> weight, bias;  // [out][in], [out]
    };
    struct Member {
        T mu, log_sigma;
    };
    struct Pixel {
        T intensity, sigma;
    };
    using FirstLayers = std::array<Array3<T>, 2>;  // [in time][y][x][out]

    /// out[o] = bias[o] + sum of weight[o][i] in[i]
    static std::vector<T> linear(const Layer& layer, const std::vector<T>& in) {
        std::vector<T> out = layer.bias;
        for (std::size_t o = 0; o < out.size(); ++o)
            for (std::size_t i = 0; i < in.size(); ++i)
                out[o] += layer.weight[o * in.size() + i] * in[i];
        return out;
    }

    /// z_{k+dk+dt}; the sample before event window k is as it was when that had not come yet.
    static const Array3<T>* code(const Codes<T>& codes, int dk, int dt) {
        return dk == -1 && dt == 1 ? nullptr : codes[std::size_t(2 + dk + dt)];
    }

    /// Layer 1 without its offset part at every sample of event window k + dk.
    Array3<T> first_layer_of(const Codes<T>& codes, int dk) const {
        const Layer& first = layers_[0];
        const int side = config_.unfold, area = side * side;
        Array3<T> sums{codes[2]->height(), codes[2]->width(), first.out};
        for (int dt = -1; dt <= 1; ++dt) {
            ConvWeights<T> part{
                first.out, config_.latent, {}, std::vector<T>(first.bias.size()), side};
            // Three convolutions, one a code, of which the first alone adds the bias.
            if (dt == -1) part.bias = first.bias;
            for (int o = 0; o < first.out; ++o)
                for (int d = 0; d < config_.latent; ++d)
                    for (int tap = 0; tap < area; ++tap)
                        part.weight.push_back(first.weight[std::size_t(
                            o * first.in + ((dt + 1) * area + tap) * config_.latent + d)]);
            const Array3<T>* z = code(codes, dk, dt);
            const Array3<T> zeros =
                z != nullptr ? Array3<T>{} : Array3<T>{sums.height(), sums.width(), config_.latent};
            sums = each(sums, conv(part, z != nullptr ? *z : zeros), std::plus<T>{});
        }
        return sums;
    }

    /// The MLP at a latent sample: what its layer 1 makes of codes is there, offsets are added.
    Member evaluate(std::span<const T> first_layer, const std::array<double, 3>& offset) const {
        const Layer& first = layers_[0];
        std::vector<T> sums(first_layer.begin(), first_layer.end());
        for (std::size_t o = 0; o < sums.size(); ++o)
            for (std::size_t d = 0; d < 3; ++d)
                sums[o] += first.weight[(o + 1) * std::size_t(first.in) - 3 + d] * T(offset[d]);
        for (std::size_t i = 1; i < layers_.size(); ++i) {
            for (T& v : sums) v = relu(v);
            sums = linear(layers_[i], sums);
        }
        return {sums[0], std::clamp(sums[1], T(config_.log_sigma_min), T(config_.log_sigma_max))};
    }

    /// Local ensemble of the samples around a query.
    /// mu = sum w mu_i; ln sigma = sum w s_i (log_blend) or sigma^2 = sum w (sigma_i^2 + mu_i^2) -
    /// mu^2 (mixture); then sigma times sigma_scale.
    Pixel blend(const FirstLayers& first_layers, const AxisSamples& t, const AxisSamples& y,
                const AxisSamples& x, SigmaRule rule) const {
        T mu = 0, log_sigma = 0, square = 0;
        for (std::size_t n = 0; n < 8; ++n) {
            const std::size_t a = n / 4, b = n / 2 % 2, c = n % 2;
            const T w = T(t.weight[a] * y.weight[b] * x.weight[c]);
            if (w == 0) continue;
            const Member member =
                evaluate(first_layers[a].pixel(y.index + int(b), x.index + int(c)),
                         {t.offset[a], x.offset[c], y.offset[b]});
            mu += w * member.mu;
            log_sigma += w * member.log_sigma;
            square += w * (std::exp(2 * member.log_sigma) + member.mu * member.mu);
        }
        const T sigma = rule == SigmaRule::log_blend ? std::exp(log_sigma)
                                                     : std::sqrt(std::max(square - mu * mu, T(0)));
        return {mu, sigma * T(config_.sigma_scale)};
    }

    ModelConfig config_;
    std::vector<Layer> layers_;
};

}  // namespace eventide::plain
