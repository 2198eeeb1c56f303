// What frames are judged by, behind the public face.
#include "src/core/error.h"
#include "src/metrics/image_measures.h"
#include "src/metrics/lpips.h"
#include "src/metrics/uncertainty.h"

#include <eventide/simulation.h>

#include <algorithm>
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

double PerceptualDistance::between(const Array2<float>& a, const Array2<float>& b) const {
    if (a.width() != b.width() || a.height() != b.height())
        throw Error(ErrorKind::usage,
                    "LPIPS: expected images of one size, found " + std::to_string(a.width()) + "x" +
                        std::to_string(a.height()) + " and " + std::to_string(b.width()) + "x" +
                        std::to_string(b.height()));
    const Lpips& lpips = impl_->lpips();
    return lpips.distance(lpips.features(a), lpips.features(b));
}

namespace {

void refuse_nan(const Array2<float>& plane, const char* name) {
    if (std::ranges::any_of(plane.values(), [](float v) { return std::isnan(v); }))
        throw Error(ErrorKind::usage, std::string{name} + ": expected numbers, found NaN");
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
    refuse_nan(intensity, "intensity");
    refuse_nan(sigma, "sigma");
    refuse_nan(truth, "truth");
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
