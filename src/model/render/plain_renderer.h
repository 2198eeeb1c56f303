// The implicit decoder in two ways, for float and double: as the formula stands (27 D inputs), and
// with layer 1 computed once a latent sample, not once a query.
#pragma once

#include "src/model/model_file.h"
#include "src/model/render/sampling.h"
#include "src/nn/load_weights.h"

#include <algorithm>
#include <array>
#include <cmath>
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

    /// As docs/model.md states it: every query unfolds its codes.
    RenderedFrame<T> render_unfolded(const Codes<T>& codes, double fraction,
                                     const FrameGeometry& geometry, SigmaRule rule) const {
        std::vector<T> input(std::size_t(layers_[0].in));
        return blend(codes, fraction, geometry, rule,
                     [&](int dk, int j, int i, const std::array<double, 3>& offset) {
                         unfold(codes, dk, j, i, input);
                         std::copy(offset.begin(), offset.end(), input.end() - 3);
                         return finish(linear(layers_[0], input));
                     });
    }

    /// The same function: the linear part of layer 1 that reads codes is a convolution of the
    /// latent maps, made once (docs/model.md, "Renderer").
    RenderedFrame<T> render(const Codes<T>& codes, double fraction, const FrameGeometry& geometry,
                            SigmaRule rule) const {
        const AxisSamples t = time_samples(codes, fraction);
        std::array<Array3<T>, 2> first_layer;
        for (int n = 0; n < 2; ++n)
            if (t.weight[std::size_t(n)] != 0)
                first_layer[std::size_t(n)] = first_layer_of(codes, t.index + n);
        const Layer& first = layers_[0];
        return blend(codes, fraction, geometry, rule,
                     [&](int dk, int j, int i, const std::array<double, 3>& offset) {
                         const auto pixel = first_layer[std::size_t(dk - t.index)].pixel(j, i);
                         std::vector<T> sum(pixel.begin(), pixel.end());
                         for (std::size_t o = 0; o < sum.size(); ++o)
                             for (std::size_t d = 0; d < 3; ++d)
                                 sum[o] += first.weight[(o + 1) * std::size_t(first.in) - 3 + d] *
                                           T(offset[d]);
                         return finish(std::move(sum));
                     });
    }

private:
    struct Layer {
        int out, in;
        std::vector<T> weight, bias;  // [out][in], [out]
    };
    struct Member {
        T mu, log_sigma;
    };

    /// out[o] = bias[o] + sum of weight[o][i] in[i]
    static std::vector<T> linear(const Layer& layer, const std::vector<T>& in) {
        std::vector<T> out = layer.bias;
        for (std::size_t o = 0; o < out.size(); ++o)
            for (std::size_t i = 0; i < in.size(); ++i)
                out[o] += layer.weight[o * in.size() + i] * in[i];
        return out;
    }

    /// The layers behind the first, from its sums.
    Member finish(std::vector<T> sums) const {
        for (std::size_t i = 1; i < layers_.size(); ++i) {
            for (T& v : sums) v = relu(v);
            sums = linear(layers_[i], sums);
        }
        return {sums[0], std::clamp(sums[1], T(config_.log_sigma_min), T(config_.log_sigma_max))};
    }

    AxisSamples time_samples(const Codes<T>& codes, double fraction) const {
        const bool fades = config_.live_edge == LiveEdge::fade && codes[1] != nullptr;
        return sample_time(fraction, codes[3] != nullptr, fades);
    }
    /// z_{k+dk+dt}; the sample before event window k is as it was when that had not come yet.
    static const Array3<T>* code(const Codes<T>& codes, int dk, int dt) {
        return dk == -1 && dt == 1 ? nullptr : codes[std::size_t(2 + dk + dt)];
    }

    /// Input n D + d is number d of the code at place n = (dt + 1) area + (dy + reach) side + dx +
    /// reach; zero where there is none.
    void unfold(const Codes<T>& codes, int dk, int j, int i, std::vector<T>& input) const {
        const auto depth = std::size_t(config_.latent);
        std::ranges::fill(input, T(0));
        const int side = config_.unfold, area = side * side, reach = side / 2;
        for (int n = 0; n < 3 * area; ++n) {
            const int dt = n / area - 1, y = j + n / side % side - reach, x = i + n % side - reach;
            const Array3<T>* z = code(codes, dk, dt);
            if (z == nullptr || y < 0 || y >= z->height() || x < 0 || x >= z->width()) continue;
            const auto code = z->pixel(y, x);
            std::copy(code.begin(), code.end(),
                      input.begin() + std::ptrdiff_t(std::size_t(n) * depth));
        }
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

    /// Local ensemble: evaluate(dk, j, i, offset) at the samples around each query.
    /// mu = sum w mu_i; ln sigma = sum w s_i (log_blend) or sigma^2 = sum w (sigma_i^2 + mu_i^2) -
    /// mu^2 (mixture); then sigma times sigma_scale.
    template <typename Evaluate>
    RenderedFrame<T> blend(const Codes<T>& codes, double fraction, const FrameGeometry& geometry,
                           SigmaRule rule, Evaluate evaluate) const {
        const int stride = config_.latent_stride;
        RenderedFrame<T> out{{geometry.part_height, geometry.part_width},
                             {geometry.part_height, geometry.part_width}};
        const AxisSamples t = time_samples(codes, fraction);
        for (int row = 0; row < geometry.part_height; ++row) {
            const AxisSamples y = sample_axis(geometry.y + row, geometry.height,
                                              geometry.sensor_height, stride, config_.blend);
            for (int column = 0; column < geometry.part_width; ++column) {
                const AxisSamples x = sample_axis(geometry.x + column, geometry.width,
                                                  geometry.sensor_width, stride, config_.blend);
                T mu = 0, log_sigma = 0, square = 0;
                for (std::size_t n = 0; n < 8; ++n) {
                    const std::size_t a = n / 4, b = n / 2 % 2, c = n % 2;
                    const T w = T(t.weight[a] * y.weight[b] * x.weight[c]);
                    if (w == 0) continue;
                    const Member member =
                        evaluate(t.index + int(a), y.index + int(b), x.index + int(c),
                                 {t.offset[a], x.offset[c], y.offset[b]});
                    mu += w * member.mu;
                    log_sigma += w * member.log_sigma;
                    square += w * (std::exp(2 * member.log_sigma) + member.mu * member.mu);
                }
                const T sigma = rule == SigmaRule::log_blend
                                    ? std::exp(log_sigma)
                                    : std::sqrt(std::max(square - mu * mu, T(0)));
                out.intensity(row, column) = mu;
                out.sigma(row, column) = sigma * T(config_.sigma_scale);
            }
        }
        return out;
    }

    ModelConfig config_;
    std::vector<Layer> layers_;
};

}  // namespace eventide::plain
