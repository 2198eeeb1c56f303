// What training makes small (docs/training.md, "Loss").
#pragma once

#include "apps/train/network/perceptual.h"
#include "apps/train/torch.h"

#include <array>
#include <cstdint>

namespace eventide {

/// Factors of the terms.
struct LossWeights {
    double l1 = 1;           ///< alone it asks for the median of what the truth may be
    double l2 = 0;           ///< of the squared error: the mean, which is brighter
    double ssim = 0.6;       ///< 1 - SSIM, mean over sizes
    double lpips = 0.4;      ///< LPIPS-Squeeze
    double nll = 0.1;        ///< of sigma; without a gradient by mu itself
    double temporal = 0.25;  ///< L1 between the changes from image to image
    double contrast = 0;     ///< 1 - structure and contrast of the image as one window
};

struct LossTerms {
    torch::Tensor total;  ///< with gradients
    /// Means without gradients: L1, 1 - SSIM, LPIPS, NLL, temporal, MSE, PICP80; all but NLL and
    /// PICP80 of what mu is drawn to.
    std::array<double, 7> means{};
};
inline constexpr std::array<const char*, 7> kLossNames{"l1",       "dssim", "lpips", "nll",
                                                       "temporal", "mse",   "picp80"};

/// Images of N streams at consecutive instants: mu, log_sigma, truth [tasks * N][h][w], task by
/// task; weight [tasks * N] says how much each counts (0 where a state has only just begun).
struct Images {
    torch::Tensor mu, log_sigma, truth, weight;
    std::int64_t streams = 1;
    torch::Tensor taught = {};  ///< what mu is drawn to, as `truth`; undefined: the truth itself

    const torch::Tensor& target() const { return taught.defined() ? taught : truth; }
};

/// `perceptual` may be null. LPIPS, the dearest term, looks at the last `lpips_tasks` tasks.
LossTerms loss(const Images& images, const LossWeights& weights, const Perceptual* perceptual,
               std::int64_t lpips_tasks);

/// Mean SSIM [M] of images [M][h][w], as scikit-image with a Gaussian of sigma 1.5, 11x11, data
/// range 1, the border of 5 px left out.
torch::Tensor ssim(const torch::Tensor& a, const torch::Tensor& b);

/// Structure and contrast of the whole image [M]: 2 cov / (var_a + var_b), 1 where a and b differ
/// by a constant. What lies far inside plain surfaces counts, which windows of 11 px don't see.
torch::Tensor whole_contrast(const torch::Tensor& a, const torch::Tensor& b);

/// Mean of SSIM over the image, its half and its quarter, as far as they are 16 px or more.
torch::Tensor multi_scale_ssim(const torch::Tensor& a, const torch::Tensor& b);

}  // namespace eventide
