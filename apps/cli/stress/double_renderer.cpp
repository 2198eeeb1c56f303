// The formulas of docs/model.md, "Renderer".
#include "apps/cli/stress/double_renderer.h"

#include "src/nn/load_weights.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>

namespace eventide::stress {

DoubleRenderer::DoubleRenderer(const Model& model) : config_{model.config} {
    for (std::size_t i = 0; i <= config_.mlp.size(); ++i) {
        const std::string name = "renderer.mlp." + std::to_string(i);
        layers_.push_back({plain::vector_of<double>(model.weights, name + ".weight"),
                           plain::vector_of<double>(model.weights, name + ".bias")});
    }
}

plain::RenderedFrame<double> DoubleRenderer::render(const Codes& codes, double fraction,
                                                    const FrameGeometry& geometry,
                                                    SigmaRule rule) const {
    const bool fades = config_.live_edge == LiveEdge::fade && codes[1] != nullptr;
    const AxisSamples t = sample_time(fraction, codes[3] != nullptr, fades);
    const AxisSamples still_t = sample_still_time(t, codes[3] != nullptr, fades);
    const Array2<std::uint8_t> still = still_pixels(config_, codes, t, still_t, geometry);
    const auto axis = [&](int at, int size, int sensor_size) {
        return sample_axis(at, size, sensor_size, config_.latent_stride, config_.blend);
    };
    plain::RenderedFrame<double> frame{{geometry.part_height, geometry.part_width},
                                       {geometry.part_height, geometry.part_width}};
    for (int row = 0; row < geometry.part_height; ++row)
        for (int column = 0; column < geometry.part_width; ++column) {
            const AxisSamples y = axis(geometry.y + row, geometry.height, geometry.sensor_height);
            const AxisSamples x = axis(geometry.x + column, geometry.width, geometry.sensor_width);
            const Pixel pixel = blend(codes, still(row, column) != 0 ? still_t : t, y, x, rule);
            frame.intensity(row, column) = pixel.intensity;
            frame.sigma(row, column) = pixel.sigma * config_.sigma_scale;
        }
    return frame;
}

/// mu = sum w mu_i; ln sigma = sum w s_i (log_blend), or sigma^2 = sum w (sigma_i^2 + mu_i^2) -
/// mu^2 (mixture)
DoubleRenderer::Pixel DoubleRenderer::blend(const Codes& codes, const AxisSamples& t,
                                            const AxisSamples& y, const AxisSamples& x,
                                            SigmaRule rule) const {
    double mu = 0, log_sigma = 0, square = 0;
    for (std::size_t a = 0; a < 2; ++a)
        for (std::size_t b = 0; b < 2; ++b)
            for (std::size_t c = 0; c < 2; ++c) {
                const double w = t.weight[a] * y.weight[b] * x.weight[c];
                if (w == 0) continue;
                const Sample sample{t.index + int(a),
                                    y.index + int(b),
                                    x.index + int(c),
                                    {t.offset[a], x.offset[c], y.offset[b]}};
                const Member member = mlp(input(codes, sample));
                mu += w * member.mu;
                log_sigma += w * member.log_sigma;
                square += w * (std::exp(2 * member.log_sigma) + member.mu * member.mu);
            }
    const double variance = std::max(square - mu * mu, 0.0);
    return {mu, rule == SigmaRule::log_blend ? std::exp(log_sigma) : std::sqrt(variance)};
}

/// The codes around a sample, zero where there is none, then its three offsets.
std::vector<double> DoubleRenderer::input(const Codes& codes, const Sample& sample) const {
    const int reach = config_.unfold / 2;
    const std::vector<double> none(std::size_t(config_.latent));
    std::vector<double> numbers;
    for (int dt = -1; dt <= 1; ++dt) {
        // The sample before event window k is as it was when that had not come yet.
        const bool unknown = sample.dk == -1 && dt == 1;
        const Array3<double>* z = unknown ? nullptr : codes[std::size_t(2 + sample.dk + dt)];
        for (int y = sample.j - reach; y <= sample.j + reach; ++y)
            for (int x = sample.i - reach; x <= sample.i + reach; ++x) {
                const bool there =
                    z != nullptr && y >= 0 && y < z->height() && x >= 0 && x < z->width();
                const auto code = there ? z->pixel(y, x) : std::span<const double>{none};
                numbers.insert(numbers.end(), code.begin(), code.end());
            }
    }
    numbers.insert(numbers.end(), sample.offset.begin(), sample.offset.end());
    return numbers;
}

DoubleRenderer::Member DoubleRenderer::mlp(std::vector<double> numbers) const {
    for (std::size_t l = 0; l < layers_.size(); ++l) {
        std::vector<double> sums = layers_[l].bias;
        for (std::size_t o = 0; o < sums.size(); ++o)
            for (std::size_t i = 0; i < numbers.size(); ++i)
                sums[o] += layers_[l].weight[o * numbers.size() + i] * numbers[i];
        if (l + 1 < layers_.size())
            for (double& sum : sums) sum = std::max(0.0, sum);
        numbers = std::move(sums);
    }
    return {numbers[0],
            std::clamp(numbers[1], double(config_.log_sigma_min), double(config_.log_sigma_max))};
}

}  // namespace eventide::stress
