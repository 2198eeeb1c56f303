// Measures between two images; sums in double, since an image has a million pixels.
#include "src/metrics/image_measures.h"

#include "src/core/error.h"
#include "src/core/number_text.h"

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <string>

namespace eventide {
namespace {

constexpr int kRadius = 5;  // px: int(truncate 3.5 * sigma 1.5 + .5), as scipy's gaussian_filter
constexpr int kTaps = 2 * kRadius + 1;
constexpr double kC1 = .01 * .01, kC2 = .03 * .03;  // (K1 L)^2 and (K2 L)^2, data range L = 1

std::string size_text(const Array2<float>& image) {
    return eventide::size_text(image.width(), image.height());
}

void need_same_size(const Array2<float>& a, const Array2<float>& b) {
    if (a.height() != b.height() || a.width() != b.width())
        throw Error(ErrorKind::usage, "two images to compare: expected the same size, found " +
                                          size_text(a) + " and " + size_text(b));
    if (a.empty())
        throw Error(ErrorKind::usage,
                    "two images to compare: expected pixels, found " + size_text(a));
}

std::array<double, kTaps> gaussian() {
    std::array<double, kTaps> weights{};
    double sum = 0;
    for (int i = -kRadius; i <= kRadius; ++i)
        sum += weights[std::size_t(i + kRadius)] = std::exp(-.5 * i * i / (1.5 * 1.5));
    for (double& w : weights) w /= sum;
    return weights;
}

/// The five local means SSIM is made of.
struct Moments {
    double a = 0, b = 0, aa = 0, bb = 0, ab = 0;
    Moments& add(double w, const Moments& m) {
        a += w * m.a;
        b += w * m.b;
        aa += w * m.aa;
        bb += w * m.bb;
        ab += w * m.ab;
        return *this;
    }
};

double similarity(const Moments& m) {
    const double var_a = m.aa - m.a * m.a, var_b = m.bb - m.b * m.b, cov = m.ab - m.a * m.b;
    return (2 * m.a * m.b + kC1) * (2 * cov + kC2) /
           ((m.a * m.a + m.b * m.b + kC1) * (var_a + var_b + kC2));
}

auto flat(const Array2<float>& image) {
    return Eigen::Map<const Eigen::ArrayXf>(image.values().data(),
                                            Eigen::Index(image.values().size()))
        .cast<double>();
}

auto flat(std::span<const double> numbers) {
    return Eigen::Map<const Eigen::ArrayXd>(numbers.data(), Eigen::Index(numbers.size()));
}

template <typename Numbers>
Spread spread_of(const Numbers& a, const Numbers& b) {
    Spread s{.mean_a = a.mean(), .mean_b = b.mean()};
    s.var_a = (a - s.mean_a).square().mean();
    s.var_b = (b - s.mean_b).square().mean();
    s.covariance = ((a - s.mean_a) * (b - s.mean_b)).mean();
    return s;
}

/// An image of less variance is flat but for rounding, and its gain would be noise.
constexpr double kFlat = 1e-12;

}  // namespace

Array2<float> clipped(const Array2<float>& image) {
    Array2<float> out = image;
    for (float& v : out.values()) v = v > 0 ? (v < 1 ? v : 1) : 0;
    return out;
}

double mean_squared_error(const Array2<float>& a, const Array2<float>& b) {
    need_same_size(a, b);
    return (flat(a) - flat(b)).square().mean();
}

Spread spread(const Array2<float>& a, const Array2<float>& b) {
    need_same_size(a, b);
    return spread_of(flat(a), flat(b));
}

Spread spread(std::span<const double> a, std::span<const double> b) {
    if (a.size() != b.size())
        throw Error(ErrorKind::usage, "spread: expected as many numbers of both, found " +
                                          std::to_string(a.size()) + " and " +
                                          std::to_string(b.size()));
    if (a.empty()) return {};
    return spread_of(flat(a), flat(b));
}

std::optional<double> correlation(const Spread& s) {
    if (s.var_a <= kFlat || s.var_b <= kFlat) return std::nullopt;
    return s.covariance / std::sqrt(s.var_a * s.var_b);
}

double structural_similarity(const Array2<float>& a, const Array2<float>& b) {
    need_same_size(a, b);
    const int height = a.height(), width = a.width();
    if (height < kTaps || width < kTaps)
        throw Error(ErrorKind::usage,
                    "SSIM: expected images of at least 11x11, found " + size_text(a));
    const auto weights = gaussian();
    // Columns first, one row of moments at a time; only pixels whose whole window lies inside
    // count, so that no border rule is needed.
    std::vector<Moments> line(static_cast<std::size_t>(width));
    double sum = 0;
    for (int y = kRadius; y < height - kRadius; ++y) {
        for (int x = 0; x < width; ++x) {
            Moments m;
            for (int i = 0; i < kTaps; ++i) {
                const double va = a(y - kRadius + i, x), vb = b(y - kRadius + i, x);
                m.add(weights[std::size_t(i)], {va, vb, va * va, vb * vb, va * vb});
            }
            line[std::size_t(x)] = m;
        }
        for (int x = kRadius; x < width - kRadius; ++x) {
            Moments m;
            for (int i = 0; i < kTaps; ++i)
                m.add(weights[std::size_t(i)], line[std::size_t(x - kRadius + i)]);
            sum += similarity(m);
        }
    }
    return sum / (double(height - 2 * kRadius) * double(width - 2 * kRadius));
}

AffineFit affine_fit(const Spread& s) {
    const double gain = s.var_a > kFlat ? s.covariance / s.var_a : 0;
    return {gain, s.mean_b - gain * s.mean_a};
}

AffineFit affine_fit(const Array2<float>& image, const Array2<float>& reference) {
    return affine_fit(spread(image, reference));
}

Array2<float> applied(const AffineFit& fit, const Array2<float>& image) {
    Array2<float> out = image;
    for (float& v : out.values()) v = float(fit.gain * double(v) + fit.offset);
    return out;
}

}  // namespace eventide
