// A correction of frames, band by band.
#include "src/model/render/residual_pyramid.h"

#include <algorithm>
#include <cmath>

namespace eventide {
namespace {

// Fitted on simulated recordings of a shaken camera (docs/model.md, "Images of the camera").
constexpr float kForgottenPerEvent = 2;
constexpr int kMaxBands = 7;

/// Where a fine pixel lies between two coarse ones: the first of them, and the weight of the
/// second.
///
///     fine      0     1     2     3     4     5
///     coarse       0           1           2         fine 1: .75 of 0, .25 of 1
struct Between {
    int first, second;
    float weight;
};
Between between(int fine, int coarse_size) {
    const int first = (fine + 1) / 2 - 1;  // weights .75 and .25
    const float weight = fine % 2 == 0 ? .75F : .25F;
    return {std::max(first, 0), std::min(first + 1, coarse_size - 1), weight};
}

}  // namespace

void fill(Array2<float>& map, float value) noexcept {
    std::ranges::fill(map.values(), value);
}

void halve(const Array2<float>& from, Array2<float>& to) noexcept {
    for (int y = 0; y < to.height(); ++y) {
        const auto upper = from.row(2 * y),
                   lower = from.row(std::min(2 * y + 1, from.height() - 1));
        for (int x = 0; x < to.width(); ++x) {
            const auto a = std::size_t(2 * x), b = std::min(a + 1, std::size_t(from.width() - 1));
            to(y, x) = .25F * (upper[a] + upper[b] + lower[a] + lower[b]);
        }
    }
}

void add_doubled(const Array2<float>& from, Array2<float>& to) noexcept {
    for (int y = 0; y < to.height(); ++y) {
        const Between v = between(y, from.height());
        const auto upper = from.row(v.first), lower = from.row(v.second);
        const auto out = to.row(y);
        for (int x = 0; x < to.width(); ++x) {
            const Between u = between(x, from.width());
            const auto i = std::size_t(u.first), j = std::size_t(u.second);
            const float a = upper[i] + v.weight * (lower[i] - upper[i]);
            const float b = upper[j] + v.weight * (lower[j] - upper[j]);
            out[std::size_t(x)] += a + u.weight * (b - a);
        }
    }
}

float ResidualPyramid::Band::rho(std::size_t i) const {
    return std::exp(-reach * events.values()[i]);
}

/// Bands as long as a side can be halved, at most 7; each answers for the same share of variance.
ResidualPyramid::ResidualPyramid(int width, int height) {
    for (int k = 0; k < kMaxBands && (k == 0 || std::min(width, height) > 1); ++k) {
        Band band;
        for (Array2<float>* map :
             {&band.residual, &band.events, &band.known, &band.sum, &band.left})
            *map = Array2<float>(height, width);
        band.reach = kForgottenPerEvent / float(1 << k);
        bands_.push_back(std::move(band));
        width = (width + 1) / 2;
        height = (height + 1) / 2;
    }
    for (Band& band : bands_) band.share = 1 / float(bands_.size());
}

void ResidualPyramid::reset() noexcept {
    for (Band& band : bands_)
        for (Array2<float>* map : {&band.residual, &band.events, &band.known}) fill(*map, 0);
}

void ResidualPyramid::forget(const Array2<float>& events) noexcept {
    const Array2<float>* now = &events;
    for (std::size_t k = 0; k < bands_.size(); ++k) {
        Band& band = bands_[k];
        if (k > 0) halve(*now, band.sum);
        if (k > 0) now = &band.sum;
        for (std::size_t i = 0; i < band.events.values().size(); ++i)
            band.events.values()[i] += now->values()[i];
    }
}

void ResidualPyramid::observe(const Array2<float>& residual, const Array2<float>& trust,
                              const Array2<float>& events) noexcept {
    // r_k = mean_k(residual) - up(mean_{k+1}(residual)); the last band is the mean itself.
    const auto copy = [](const Array2<float>& from, Array2<float>& to) {
        std::ranges::copy(from.values(), to.values().begin());
    };
    // Up: what is known of each band, and the means that the bands are differences of.
    for (std::size_t k = 0; k < bands_.size(); ++k) {
        Band& band = bands_[k];
        k == 0 ? copy(trust, band.left) : halve(bands_[k - 1].left, band.left);
        for (std::size_t i = 0; i < band.known.values().size(); ++i) {
            const float sure = band.left.values()[i];
            // u <- trust + (1 - trust) u rho: rho by the events since the image before, which are
            // replaced after this.
            band.known.values()[i] = sure + (1 - sure) * band.known.values()[i] * band.rho(i);
        }
        k == 0 ? copy(events, band.events) : halve(bands_[k - 1].events, band.events);
        k == 0 ? copy(residual, band.residual) : halve(bands_[k - 1].residual, band.residual);
    }
    // Each less the doubled one above; from the finest on, so that the one above is still whole.
    for (std::size_t k = 0; k + 1 < bands_.size(); ++k) {
        fill(bands_[k].sum, 0);
        add_doubled(bands_[k + 1].residual, bands_[k].sum);
        for (std::size_t i = 0; i < bands_[k].sum.values().size(); ++i)
            bands_[k].residual.values()[i] -= bands_[k].sum.values()[i];
    }
}

/// correction = sum over k of up(rho_k r_k), variance = sum over k of up(s_k (1 - (u_k rho_k)^2)):
/// from the coarsest on each band is added to the doubled sum of those above it.
void ResidualPyramid::expect(Array2<float>& correction, Array2<float>& variance) noexcept {
    for (std::size_t k = bands_.size(); k-- > 0;) {
        Band& band = bands_[k];
        Array2<float>& sum = k == 0 ? correction : band.sum;
        Array2<float>& left = k == 0 ? variance : band.left;
        for (std::size_t i = 0; i < band.residual.values().size(); ++i) {
            const float rho = band.rho(i);
            sum.values()[i] = rho * band.residual.values()[i];
            const float known = rho * band.known.values()[i];
            left.values()[i] = band.share * (1 - known * known);
        }
        if (k + 1 == bands_.size()) continue;
        add_doubled(bands_[k + 1].sum, sum);
        add_doubled(bands_[k + 1].left, left);
    }
}

}  // namespace eventide
