#include "apps/train/network/render.h"

#include "apps/train/fused/fused.h"
#include "apps/train/network/networks.h"
#include "src/model/render/sampling.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace eventide {
namespace {

/// The lower and upper neighbour of each point along one axis. Beyond the last sample only that one
/// is used, with its true offset (docs/model.md).
std::array<fused::WeightedAxis, 2> neighbours(const std::vector<double>& points,
                                              std::int64_t samples, Blend blend) {
    std::array<fused::WeightedAxis, 2> both;
    for (int side = 0; side < 2; ++side) {
        fused::WeightedAxis& axis = both[std::size_t(side)];
        for (const double p : points) {
            const double low = std::min(std::floor(p), double(samples - 1));
            const double part = low == double(samples - 1) ? 0 : blend_weight(p - low, blend);
            const double sample = std::min(low + side, double(samples - 1));
            axis.index.push_back(std::int64_t(sample));
            axis.offset.push_back(p - sample);
            axis.weight.push_back(side == 0 ? 1 - part : part);
        }
    }
    return both;
}

/// The learned function with its first layer taken apart: a convolution of codes plus a linear
/// function of the offset (docs/model.md, "Renderer").
class Mlp {
public:
    Mlp(const ModelConfig& config, const Parameters& parameters) {
        for (std::size_t i = 0; i <= config.mlp.size(); ++i) {
            const std::string name = "renderer.mlp." + std::to_string(i);
            weight_.push_back(parameters.at(name + ".weight"));
            bias_.push_back(parameters.at(name + ".bias"));
        }
        const int D = config.latent, H = int(weight_[0].size(0)), side = config.unfold;
        // [H][dt][dy][dx][D] -> [H][dt, D][dy][dx]
        conv_ = weight_[0]
                    .narrow(1, 0, config.unfolded())
                    .reshape({H, 3, side, side, D})
                    .permute({0, 1, 4, 2, 3})
                    .reshape({H, 3 * D, side, side});
        offset_ = weight_[0].narrow(1, config.unfolded(), 3);
    }

    /// Layer 1 before its offset and rectifier: [M][H_1][h][w] of codes [M][3 D][h][w].
    torch::Tensor first(const torch::Tensor& codes) const {
        return torch::conv2d(codes.to(conv_.scalar_type()), conv_, bias_[0], 1, conv_.size(2) / 2);
    }
    /// Weights of the offset (t, x, y), [H_1][3].
    const torch::Tensor& offsets() const { return offset_; }

    /// The rest, of the rectified first layer: [M][H_1][r][c] -> [M][2][r][c] in float32.
    torch::Tensor rest(torch::Tensor x) const {
        for (std::size_t i = 1; i < weight_.size(); ++i) {
            x = torch::conv2d(x, weight_[i].unsqueeze(-1).unsqueeze(-1), bias_[i]);
            if (i + 1 < weight_.size()) x = rectify(x);
        }
        return x.to(wide());
    }
    /// All linear layers.
    const std::vector<torch::Tensor>& weights() const { return weight_; }
    const std::vector<torch::Tensor>& biases() const { return bias_; }
    torch::ScalarType wide() const {
        return conv_.scalar_type() == torch::kDouble ? torch::kDouble : torch::kFloat;
    }

private:
    std::vector<torch::Tensor> weight_, bias_;
    torch::Tensor conv_, offset_;
};

/// A centre sample in time: its three codes, the offset and the weight of each image.
struct Centre {
    torch::Tensor codes;   ///< [N][3 D][h][w]
    torch::Tensor offset;  ///< [N], t - t_v
    torch::Tensor weight;  ///< [N]
    std::size_t task;
};

torch::Tensor or_zero(const torch::Tensor& map, const torch::Tensor& like) {
    return map.defined() ? map : torch::zeros_like(like);
}

std::vector<Centre> centres(const std::vector<RenderTask>& tasks) {
    std::vector<Centre> list;
    for (std::size_t i = 0; i < tasks.size(); ++i) {
        const RenderTask& task = tasks[i];
        const auto &z = task.current, &next = task.next;
        if (!next.defined() && task.before.defined()) {
            // What was shown at the beginning of the window, until the newest codes take over.
            list.push_back({torch::cat({task.before, task.previous, torch::zeros_like(z)}, 1),
                            torch::ones_like(task.f), 1 - task.f, i});
            list.push_back(
                {torch::cat({task.previous, z, torch::zeros_like(z)}, 1), task.f, task.f, i});
            continue;
        }
        list.push_back({torch::cat({or_zero(task.previous, z), z, or_zero(next, z)}, 1), task.f,
                        next.defined() ? 1 - task.f : torch::ones_like(task.f), i});
        if (next.defined())
            list.push_back(
                {torch::cat({z, next, or_zero(task.after, z)}, 1), task.f - 1, task.f, i});
    }
    return list;
}

template <typename Member>
torch::Tensor concat(const std::vector<Centre>& list, Member member) {
    std::vector<torch::Tensor> parts;
    for (const Centre& centre : list) parts.push_back(centre.*member);
    return torch::cat(parts, 0);
}

/// What is blended: mu beside ln sigma, or beside the second moment (docs/model.md, sigma rules).
torch::Tensor moments(const ModelConfig& config, const torch::Tensor& out) {
    const auto mu = out.narrow(1, 0, 1);
    auto second = out.narrow(1, 1, 1).clamp(config.log_sigma_min, config.log_sigma_max);
    if (config.sigma_rule == SigmaRule::mixture) second = (2 * second).exp() + mu.square();
    return torch::cat({mu, second}, 1);
}

std::vector<double> numbers(const torch::Tensor& x) {
    const torch::Tensor flat = x.to(torch::kCPU, torch::kDouble).contiguous();
    return {flat.data_ptr<double>(), flat.data_ptr<double>() + flat.numel()};
}

/// Weighted sums over the up to 4 neighbours in space: [M][2][r][c]; dt and weight [M].
torch::Tensor blend_space(const ModelConfig& config, const Mlp& mlp, const torch::Tensor& first,
                          const torch::Tensor& dt, const torch::Tensor& weight,
                          const PatchGrid& points) {
    const auto y = neighbours(points.y, first.size(2), config.blend);
    const auto x = neighbours(points.x, first.size(3), config.blend);
    if (fused::members_fused(first, mlp.weights())) {
        auto blend = c10::make_intrusive<fused::MemberBlend>();
        blend->y = y;
        blend->x = x;
        blend->dt = numbers(dt);
        blend->weight = numbers(weight);
        blend->log_sigma_min = config.log_sigma_min;
        blend->log_sigma_max = config.log_sigma_max;
        blend->squares = config.sigma_rule == SigmaRule::mixture;
        return fused::members(first, mlp.offsets(), mlp.weights(), mlp.biases(), blend);
    }
    const auto options = first.options().dtype(mlp.wide());
    const auto empty = [](const fused::WeightedAxis& axis) {
        return std::ranges::all_of(axis.weight, [](double w) { return w == 0; });
    };
    const auto share = [&](const fused::WeightedAxis& axis) {
        return torch::tensor(axis.weight, torch::kDouble).to(options);
    };
    torch::Tensor sum;
    for (const auto& ny : y) {
        if (empty(ny)) continue;
        for (const auto& nx : x) {
            if (empty(nx)) continue;
            const auto out = mlp.rest(fused::offset_layer(first, dt, mlp.offsets(), ny, nx));
            const auto part = moments(config, out) * (share(ny).view({-1, 1}) * share(nx));
            sum = sum.defined() ? sum + part : part;
        }
    }
    return weight.view({-1, 1, 1, 1}) * sum;
}

}  // namespace

PatchGrid patch_grid(double y0, double x0, double span, int size) {
    PatchGrid grid;
    for (int i = 0; i < size; ++i) {
        grid.y.push_back(y0 + span * i / (size - 1));
        grid.x.push_back(x0 + span * i / (size - 1));
    }
    return grid;
}

Rendered render(const ModelConfig& config, const Parameters& parameters,
                const std::vector<RenderTask>& tasks, const PatchGrid& points) {
    const Mlp mlp{config, parameters};
    const std::vector<Centre> list = centres(tasks);
    const torch::Tensor first = mlp.first(concat(list, &Centre::codes));
    const torch::Tensor dt = concat(list, &Centre::offset).to(mlp.wide());
    const torch::Tensor weight = concat(list, &Centre::weight).to(mlp.wide());
    const torch::Tensor weighted = blend_space(config, mlp, first, dt, weight, points);
    // Back from centres to images: each task has one or two centres of N streams.
    const std::int64_t streams = tasks.front().f.size(0);
    std::vector<torch::Tensor> images(tasks.size());
    for (std::size_t i = 0; i < list.size(); ++i) {
        const auto part = weighted.narrow(0, std::int64_t(i) * streams, streams);
        torch::Tensor& image = images[list[i].task];
        image = image.defined() ? image + part : part;
    }
    const torch::Tensor out = torch::cat(images, 0);
    const torch::Tensor mu = out.select(1, 0), second = out.select(1, 1);
    if (config.sigma_rule == SigmaRule::log_blend) return {mu, second};
    return {mu, 0.5 * (second - mu.square()).clamp_min(1e-6).log()};
}

}  // namespace eventide
