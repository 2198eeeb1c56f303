// How far a frame is from the truth, and whether its sigma knew.
#pragma once

#include <eventide/array.h>
#include <eventide/version.h>

#include <optional>

namespace eventide {

/// Of one frame, all pixels alike. Numbers as `eventide evaluate` prints them.
struct FrameMeasures {
    double mse = 0;   ///< mean of (intensity - truth)^2
    double ssim = 0;  ///< structural similarity (Wang et al. 2004), Gaussian window of 11 px
    double affine_mse =
        0;  ///< both again after the gain and offset that bring the frame nearest to
    double affine_ssim = 0;  ///< the truth: what is left when brightness is forgiven

    // Empty where there is no sigma.
    std::optional<double>
        picp80;  ///< share of pixels within 1.2816 sigma of the truth; .8 is right
    std::optional<double> log_likelihood;  ///< mean, nats per pixel, of a Gaussian of this sigma
};

/// `intensity` is clipped to 0..1 first; `sigma` may be empty. [y][x], of one size, at least 11 px
/// each way. Throws Error (usage) else.
EVENTIDE_API FrameMeasures measure(const Array2<float>& intensity, const Array2<float>& sigma,
                                   const Array2<float>& truth);

}  // namespace eventide
