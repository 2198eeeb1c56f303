#include "apps/train/network/losses.h"

#include <algorithm>
#include <cmath>

namespace eventide {
namespace {

constexpr int kRadius = 5;  // of the 11x11 window

/// The window as a matrix [n - 10][n], so that filtering is two products, which libtorch does far
/// faster than convolutions of one channel.
torch::Tensor blur_matrix(std::int64_t n, torch::TensorOptions options) {
    std::vector<float> window;
    float sum = 0;
    for (int i = -kRadius; i <= kRadius; ++i) {
        window.push_back(std::exp(-float(i * i) / (2 * 1.5F * 1.5F)));
        sum += window.back();
    }
    torch::Tensor matrix = torch::zeros({n - 2 * kRadius, n});
    auto cells = matrix.accessor<float, 2>();
    for (std::int64_t row = 0; row < matrix.size(0); ++row)
        for (int i = 0; i <= 2 * kRadius; ++i) cells[row][row + i] = window[std::size_t(i)] / sum;
    return matrix.to(options);
}

/// Weighted mean over images; 0 where all weights are.
torch::Tensor mean_of(const torch::Tensor& per_image, const torch::Tensor& weight) {
    return (per_image * weight).sum() / weight.sum().clamp_min(1e-6);
}

torch::Tensor temporal_change(const Images& p) {
    const std::int64_t n = p.mu.size(0) - p.streams;
    if (n <= 0) return torch::zeros({}, p.mu.options());
    const auto change = [&](const torch::Tensor& x) {
        return x.narrow(0, p.streams, n) - x.narrow(0, 0, n);
    };
    return mean_of((change(p.mu) - change(p.target())).abs().mean({1, 2}),
                   p.weight.narrow(0, 0, n));
}

torch::Tensor perceptual_distance(const Images& p, const Perceptual& perceptual,
                                  std::int64_t tasks) {
    const std::int64_t n = std::min(p.mu.size(0), tasks * p.streams), first = p.mu.size(0) - n;
    return mean_of(perceptual.distance(p.mu.narrow(0, first, n), p.truth.narrow(0, first, n)),
                   p.weight.narrow(0, first, n));
}

}  // namespace

torch::Tensor ssim(const torch::Tensor& a, const torch::Tensor& b) {
    const torch::Tensor Gy = blur_matrix(a.size(1), a.options());
    const torch::Tensor Gx = blur_matrix(a.size(2), a.options()).t();
    const auto all =
        torch::matmul(torch::matmul(Gy, torch::stack({a, b, a * a, b * b, a * b})), Gx);
    const auto mean_a = all[0], mean_b = all[1];
    const auto var_a = all[2] - mean_a * mean_a, var_b = all[3] - mean_b * mean_b;
    const auto cov = all[4] - mean_a * mean_b;
    constexpr double C1 = 0.01 * 0.01, C2 = 0.03 * 0.03;
    const auto map = ((2 * mean_a * mean_b + C1) * (2 * cov + C2)) /
                     ((mean_a * mean_a + mean_b * mean_b + C1) * (var_a + var_b + C2));
    return map.mean({1, 2});
}

torch::Tensor whole_contrast(const torch::Tensor& a, const torch::Tensor& b) {
    constexpr double C2 = 0.03 * 0.03;
    const auto u = a - a.mean({1, 2}, true), v = b - b.mean({1, 2}, true);
    return (2 * (u * v).mean({1, 2}) + C2) / ((u * u + v * v).mean({1, 2}) + C2);
}

torch::Tensor multi_scale_ssim(const torch::Tensor& a, const torch::Tensor& b) {
    torch::Tensor x = a, y = b, sum = ssim(a, b);
    int sizes = 1;
    for (; sizes < 3 && std::min(x.size(1), x.size(2)) >= 32; ++sizes) {
        x = torch::avg_pool2d(x, 2);
        y = torch::avg_pool2d(y, 2);
        sum = sum + ssim(x, y);
    }
    return sum / sizes;
}

LossTerms loss(const Images& p, const LossWeights& weights, const Perceptual* perceptual,
               std::int64_t lpips_tasks) {
    const auto zero = torch::zeros({}, p.mu.options());
    const auto& target = p.target();
    const auto error = target - p.mu;
    const auto l1 = mean_of(error.abs().mean({1, 2}), p.weight);
    const auto dssim = 1 - mean_of(multi_scale_ssim(p.mu, target), p.weight);
    const auto lpips = perceptual != nullptr && weights.lpips > 0
                           ? perceptual_distance(p, *perceptual, lpips_tasks)
                           : zero;
    const auto l2 = mean_of(error.square().mean({1, 2}), p.weight);
    const auto squared = (p.truth - p.mu).detach().square();  // sigma answers for the truth alone
    const auto nll =
        mean_of((p.log_sigma + 0.5 * squared * (-2 * p.log_sigma).exp()).mean({1, 2}), p.weight);
    const auto temporal = temporal_change(p);
    const auto inside =
        (squared.sqrt() <= 1.2816 * p.log_sigma.detach().exp()).to(torch::kFloat).mean({1, 2});
    const auto contrast =
        weights.contrast > 0 ? 1 - mean_of(whole_contrast(p.mu, target), p.weight) : zero;
    const auto total = weights.l1 * l1 + weights.l2 * l2 + weights.ssim * dssim +
                       weights.contrast * contrast + weights.lpips * lpips + weights.nll * nll +
                       weights.temporal * temporal;
    // All at once: a GPU is waited for each time.
    const auto means =
        torch::stack({l1, dssim, lpips, nll, temporal, l2, mean_of(inside, p.weight)})
            .detach()
            .to(torch::kCPU, torch::kDouble);
    LossTerms terms{total, {}};
    std::copy_n(means.data_ptr<double>(), terms.means.size(), terms.means.begin());
    return terms;
}

}  // namespace eventide
