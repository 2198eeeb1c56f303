// What frames are judged by, behind the public face.
#include "src/metrics/image_measures.h"
#include "src/metrics/uncertainty.h"

#include <eventide/simulation.h>

namespace eventide {

FrameMeasures measure(const Array2<float>& intensity, const Array2<float>& sigma,
                      const Array2<float>& truth) {
    const Array2<float> shown = clipped(intensity);
    FrameMeasures measures;
    measures.mse = mean_squared_error(shown, truth);
    measures.ssim = structural_similarity(shown, truth);
    const Array2<float> fitted = clipped(applied(affine_fit(shown, truth), shown));
    measures.affine_mse = mean_squared_error(fitted, truth);
    measures.affine_ssim = structural_similarity(fitted, truth);
    if (sigma.empty()) return measures;
    measures.picp80 = coverage_80(shown, sigma, truth);
    measures.log_likelihood = log_likelihood(shown, sigma, truth);
    return measures;
}

}  // namespace eventide
