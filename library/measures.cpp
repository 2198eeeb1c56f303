// What frames are judged by, behind the public face.
#include "src/core/error.h"
#include "src/core/number_text.h"
#include "src/metrics/image_measures.h"
#include "src/metrics/lpips.h"
#include "src/metrics/uncertainty.h"

#include <eventide/simulation.h>

#include <cmath>
#include <string>

namespace eventide {

class PerceptualDistance::Impl {
public:
    explicit Impl(const std::filesystem::path& weights) : lpips_(weights) {}
    const Lpips& lpips() const { return lpips_; }

private:
    const Lpips lpips_;
};

PerceptualDistance::PerceptualDistance(const std::filesystem::path& weights)
    : impl_(std::make_unique<const Impl>(weights)) {}
PerceptualDistance::~PerceptualDistance() = default;
PerceptualDistance::PerceptualDistance(PerceptualDistance&&) noexcept = default;
PerceptualDistance& PerceptualDistance::operator=(PerceptualDistance&&) noexcept = default;

std::string PerceptualDistance::name() const {
    return impl_->lpips().name();
}

namespace {

void refuse_not_finite(const Array2<float>& plane, const char* name) {
    for (const float v : plane.values())
        if (!std::isfinite(v))
            throw Error(ErrorKind::usage, std::string{name} + ": expected finite numbers, found " +
                                              std::to_string(v));
}

}  // namespace

double PerceptualDistance::between(const Array2<float>& a, const Array2<float>& b) const {
    if (a.width() != b.width() || a.height() != b.height())
        throw Error(ErrorKind::usage, "LPIPS: expected images of one size, found " +
                                          size_text(a.width(), a.height()) + " and " +
                                          size_text(b.width(), b.height()));
    refuse_not_finite(a, "LPIPS, first image");
    refuse_not_finite(b, "LPIPS, second image");
    const Lpips& lpips = impl_->lpips();
    return lpips.distance(lpips.features(a), lpips.features(b));
}

namespace {

void refuse_other_size(const Array2<float>& plane, const char* name,
                       const Array2<float>& intensity) {
    if (plane.width() != intensity.width() || plane.height() != intensity.height())
        throw Error(ErrorKind::usage, std::string{name} + ": expected the size of intensity, " +
                                          size_text(intensity.width(), intensity.height()) +
                                          ", found " + size_text(plane.width(), plane.height()));
}

void refuse_below_zero(const Array2<float>& sigma) {
    for (const float s : sigma.values())
        if (s < 0)
            throw Error(ErrorKind::usage,
                        "sigma: expected 0 or more everywhere, found " + std::to_string(s));
}

}  // namespace

FrameMeasures measure(const Array2<float>& intensity, const Array2<float>& sigma,
                      const Array2<float>& truth, const PerceptualDistance* lpips) {
    refuse_other_size(truth, "truth", intensity);
    if (!sigma.empty()) refuse_other_size(sigma, "sigma", intensity);
    refuse_not_finite(intensity, "intensity");
    refuse_not_finite(sigma, "sigma");
    refuse_not_finite(truth, "truth");
    refuse_below_zero(sigma);
    const Array2<float> shown = clipped(intensity);
    FrameMeasures measures;
    measures.mse = mean_squared_error(shown, truth);
    measures.ssim = structural_similarity(shown, truth);
    const Array2<float> fitted = clipped(applied(affine_fit(shown, truth), shown));
    measures.affine_mse = mean_squared_error(fitted, truth);
    measures.affine_ssim = structural_similarity(fitted, truth);
    if (lpips != nullptr) measures.lpips = lpips->between(shown, truth);
    if (sigma.empty()) return measures;
    measures.picp80 = coverage_80(shown, sigma, truth);
    measures.log_likelihood = log_likelihood(shown, sigma, truth);
    return measures;
}

}  // namespace eventide
