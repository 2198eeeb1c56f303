// How far one image is from another: mean squared error, structural similarity, correlation, and
// the gain and offset that would bring them together.
#pragma once

#include "src/core/array.h"

#include <optional>
#include <span>

namespace eventide {

/// A copy with every number brought into [0, 1]; not-a-number becomes 0.
Array2<float> clipped(const Array2<float>& image);

/// Mean of (a - b)^2. Both of one size, else Error(usage).
double mean_squared_error(const Array2<float>& a, const Array2<float>& b);

/// SSIM as scikit-image's structural_similarity(gaussian_weights=True, sigma=1.5,
/// use_sample_covariance=False, data_range=1): Gaussian cut at 3.5 sigma, so 11 x 11 weights,
/// constants .01^2 and .03^2, the mean over all but 5 px at each border. Both of one size, at least
/// 11 x 11 px, else Error(usage).
double structural_similarity(const Array2<float>& a, const Array2<float>& b);

/// Means, variances and covariance over all pixels of two images.
struct Spread {
    double mean_a = 0, mean_b = 0, var_a = 0, var_b = 0, covariance = 0;
};

/// Both of one size, else Error(usage).
Spread spread(const Array2<float>& a, const Array2<float>& b);
/// As many of each, else Error(usage); of none all is 0.
Spread spread(std::span<const double> a, std::span<const double> b);

/// Pearson's, -1 to 1; nothing where either side does not vary.
std::optional<double> correlation(const Spread& spread);

/// image * gain + offset.
struct AffineFit {
    double gain = 1, offset = 0;
};

/// The gain and offset that bring the first image nearest to the second.
AffineFit affine_fit(const Spread& spread);

/// The gain and offset that bring `image` nearest to `reference` in the mean square. A constant
/// image has gain 0 and the reference's mean.
AffineFit affine_fit(const Array2<float>& image, const Array2<float>& reference);

Array2<float> applied(const AffineFit& fit, const Array2<float>& image);

}  // namespace eventide
