// Sums over pixels of standardised errors z = (reference - mu) / sigma.
#include "src/metrics/uncertainty.h"

#include "src/core/error.h"
#include "src/core/number_text.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace eventide {
namespace {

constexpr double kZ80 = 1.2815515655446004;  // standard normal quantile at .9

// Standard normal quantiles at .05, .10 ... .95 (upper half; the lower is its mirror), and those of
// the central intervals that hold .05 ... .95.
constexpr std::array<double, Reliability::kLevels> kQuantile{
    -1.6448536269514729, -1.2815515655446004,
    -1.0364333894937898, -.84162123357291442,
    -.67448975019608171, -.52440051270804066,
    -.38532046640756773, -.25334710313579972,
    -.12566134685507416, 0,
    .12566134685507416,  .25334710313579972,
    .38532046640756773,  .52440051270804066,
    .67448975019608171,  .84162123357291442,
    1.0364333894937898,  1.2815515655446004,
    1.6448536269514729};
constexpr std::array<double, Reliability::kLevels> kCentral{
    .062706777943213846, .12566134685507416, .18911842627279253, .25334710313579972,
    .31863936396437514,  .38532046640756773, .45376219016987951, .52440051270804066,
    .59776012604247841,  .67448975019608171, .75541502636046909, .84162123357291442,
    .93458929107347943,  1.0364333894937898, 1.1503493803760083, 1.2815515655446004,
    1.4395314709384563,  1.6448536269514729, 1.9599639845400545};

void need_same_size(const Array2<float>& mu, const Array2<float>& sigma,
                    const Array2<float>& reference) {
    const auto same = [&](const Array2<float>& other) {
        return mu.height() == other.height() && mu.width() == other.width();
    };
    if (!same(sigma) || !same(reference) || mu.empty())
        throw Error(ErrorKind::usage,
                    "mu, sigma and reference: expected images of one size, with pixels, found " +
                        size_text(mu.width(), mu.height()) + ", " +
                        size_text(sigma.width(), sigma.height()) + " and " +
                        size_text(reference.width(), reference.height()));
}

/// Calls use(z, sigma) for each pixel. What is certain and right is as near as can be: z is 0.
template <typename Use>
void for_each_error(const Array2<float>& mu, const Array2<float>& sigma,
                    const Array2<float>& reference, Use use) {
    need_same_size(mu, sigma, reference);
    for (std::size_t i = 0; i < mu.values().size(); ++i) {
        const double s = double(sigma.values()[i]);
        const double error = double(reference.values()[i]) - double(mu.values()[i]);
        use(error == 0 ? 0 : error / s, s);
    }
}

template <typename Reduce>
std::vector<double> over_patches(const Array2<float>& map, int size, Reduce reduce) {
    std::vector<double> out;
    std::vector<float> patch;
    for (int y = 0; y + size <= map.height(); y += size)
        for (int x = 0; x + size <= map.width(); x += size) {
            patch.clear();
            for (int dy = 0; dy < size; ++dy) {
                const auto row = map.row(y + dy).subspan(std::size_t(x), std::size_t(size));
                patch.insert(patch.end(), row.begin(), row.end());
            }
            out.push_back(reduce(patch));
        }
    return out;
}

}  // namespace

double coverage_80(const Array2<float>& mu, const Array2<float>& sigma,
                   const Array2<float>& reference) {
    std::uint64_t inside = 0;
    for_each_error(mu, sigma, reference,
                   [&](double z, double) { inside += std::abs(z) <= kZ80 ? 1 : 0; });
    return double(inside) / double(mu.values().size());
}

double log_likelihood(const Array2<float>& mu, const Array2<float>& sigma,
                      const Array2<float>& reference) {
    double sum = 0;
    bool impossible = false;  // one pixel that is certain and wrong, whatever the others say
    for_each_error(mu, sigma, reference, [&](double z, double s) {
        impossible |= std::isinf(z);
        sum -= std::log(s) + .5 * z * z;
    });
    if (impossible) return -std::numeric_limits<double>::infinity();
    return sum / double(mu.values().size()) - .5 * std::log(2 * std::numbers::pi);
}

std::vector<double> patch_means(const Array2<float>& map, int size) {
    return over_patches(map, size, [](const std::vector<float>& patch) {
        double sum = 0;
        for (const float v : patch) sum += double(v);
        return sum / double(patch.size());
    });
}

std::vector<double> patch_medians(const Array2<float>& map, int size) {
    return over_patches(map, size, [](std::vector<float>& patch) {
        const auto half = patch.begin() + std::ptrdiff_t(patch.size() / 2);
        std::nth_element(patch.begin(), half, patch.end());
        if (patch.size() % 2 == 1) return double(*half);
        return .5 * (double(*half) + double(*std::max_element(patch.begin(), half)));
    });
}

void Reliability::add(const Array2<float>& mu, const Array2<float>& sigma,
                      const Array2<float>& reference) {
    // Counted by the first level that holds the pixel; sums are formed when asked for.
    const auto rank = [](const std::array<double, kLevels>& levels, double z) {
        return std::size_t(std::lower_bound(levels.begin(), levels.end(), z) - levels.begin());
    };
    for_each_error(mu, sigma, reference, [&](double z, double) {
        ++inside_[rank(kCentral, std::abs(z))];
        ++below_[rank(kQuantile, z)];
        ++pixels_;
    });
}

Reliability& Reliability::operator+=(const Reliability& other) {
    for (std::size_t i = 0; i < inside_.size(); ++i) {
        inside_[i] += other.inside_[i];
        below_[i] += other.below_[i];
    }
    pixels_ += other.pixels_;
    return *this;
}

double Reliability::share(const Counts& counts, int i) const {
    std::uint64_t sum = 0;
    for (int j = 0; j <= i; ++j) sum += counts[std::size_t(j)];
    return double(sum) / double(pixels_);
}

void SigmaScale::add(const Array2<float>& mu, const Array2<float>& sigma,
                     const Array2<float>& reference) {
    for_each_error(mu, sigma, reference, [this](double z, double s) {
        squares_ += z * z;
        log_sigmas_ += std::log(s);
        const double bin = (std::log(std::abs(z)) + 8) * (kBins / 16.);
        ++bins_[std::size_t(std::clamp(bin, 0., kBins - 1.))];
        ++pixels_;
    });
}

SigmaScale& SigmaScale::operator+=(const SigmaScale& other) {
    for (std::size_t i = 0; i < kBins; ++i) bins_[i] += other.bins_[i];
    squares_ += other.squares_;
    log_sigmas_ += other.log_sigmas_;
    pixels_ += other.pixels_;
    return *this;
}

double SigmaScale::by_likelihood() const {
    return pixels_ == 0 ? 1 : std::sqrt(squares_ / double(pixels_));
}

double SigmaScale::by_coverage() const {
    std::uint64_t seen = 0;
    for (int i = 0; i < kBins; ++i) {
        seen += bins_[std::size_t(i)];
        if (double(seen) >= .8 * double(pixels_) && pixels_ > 0)
            return std::exp((i + .5) * (16. / kBins) - 8) / kZ80;
    }
    return 1;
}

double SigmaScale::coverage_80_after(double factor) const {
    const double edge = (std::log(kZ80 * factor) + 8) * (kBins / 16.);
    double inside = 0;
    for (int i = 0; i < kBins; ++i)
        inside += double(bins_[std::size_t(i)]) * std::clamp(edge - i, 0., 1.);
    return inside / double(pixels_);
}

double SigmaScale::log_likelihood_after(double factor) const {
    const double n = double(pixels_);
    return -.5 * std::log(2 * std::numbers::pi) - log_sigmas_ / n - std::log(factor) -
           .5 * squares_ / n / (factor * factor);
}

}  // namespace eventide
