// Whether sigma is true: coverage, likelihood, reliability, and its agreement with what looks
// wrong.
#pragma once

#include "src/core/array.h"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace eventide {

/// Share of |reference - mu| <= 1.2816 sigma: .8 where sigma is right and errors are Gaussian.
double coverage_80(const Array2<float>& mu, const Array2<float>& sigma,
                   const Array2<float>& reference);

/// Mean of -ln(2 pi)/2 - ln sigma - (reference - mu)^2 / (2 sigma^2), in nats per pixel. Where
/// sigma is 0 it is infinite: below 0 where such a pixel is wrong, above where all such are right.
double log_likelihood(const Array2<float>& mu, const Array2<float>& sigma,
                      const Array2<float>& reference);

/// One number per whole patch of `size` x `size` px, from the top left; what is left over at the
/// right and bottom is not used.
std::vector<double> patch_means(const Array2<float>& map, int size);
std::vector<double> patch_medians(const Array2<float>& map, int size);

/// The reliability diagram: how often the truth lies below the q-quantile that mu and sigma
/// promise, for q = 0.05, 0.10 ... 0.95.
class Reliability {
public:
    static constexpr int kLevels = 19;
    static double level(int i) { return .05 * (i + 1); }

    void add(const Array2<float>& mu, const Array2<float>& sigma, const Array2<float>& reference);
    /// Share of pixels inside the central interval that promises `level(i)`.
    double inside(int i) const { return share(inside_, i); }
    /// Share of pixels below the quantile `level(i)`.
    double below(int i) const { return share(below_, i); }
    std::uint64_t pixels() const { return pixels_; }
    Reliability& operator+=(const Reliability& other);

private:
    using Counts = std::array<std::uint64_t, kLevels + 1>;  // the last: past every level
    double share(const Counts& counts, int i) const;
    Counts inside_{}, below_{};
    std::uint64_t pixels_ = 0;
};

/// Finds the one factor for sigma that makes the likelihood of held-out images largest: for a
/// Gaussian the root of the mean of ((reference - mu) / sigma)^2. A robust variant brings the
/// coverage to .8 instead.
class SigmaScale {
public:
    void add(const Array2<float>& mu, const Array2<float>& sigma, const Array2<float>& reference);
    double by_likelihood() const;
    /// The .8 quantile of |reference - mu| / sigma, over 1.2816; to about 1 %.
    double by_coverage() const;

    /// What coverage_80() and log_likelihood() are, over all pixels, once sigma is multiplied by
    /// `factor`. The coverage is read from bins, to about .001.
    double coverage_80_after(double factor) const;
    double log_likelihood_after(double factor) const;
    std::uint64_t pixels() const { return pixels_; }
    SigmaScale& operator+=(const SigmaScale& other);

private:
    static constexpr int kBins = 1600;  ///< of ln(|z|), from -8 to 8
    std::array<std::uint64_t, kBins> bins_{};
    double squares_ = 0, log_sigmas_ = 0;
    std::uint64_t pixels_ = 0;
};

}  // namespace eventide
