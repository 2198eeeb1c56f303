// A correction of frames, band by band.
#include "src/model/render/residual_pyramid.h"

#include "src/model/render/half_maps.h"

#include <algorithm>
#include <cmath>

namespace eventide {
namespace {

// Fitted on simulated recordings of a shaken camera (docs/model.md, "Images of the camera").
constexpr float kForgottenPerEvent = 2;
constexpr int kMaxBands = 7;

}  // namespace

void ResidualPyramid::Band::fade() noexcept {
    for (std::size_t i = 0; i < rho.values().size(); ++i) {
        const float n = events.values()[i];
        rho.values()[i] = n == 0 ? 1 : std::exp(-reach * n);
    }
}

/// Bands as long as a side can be halved, at most 7; each answers for the same share of variance.
ResidualPyramid::ResidualPyramid(int width, int height) {
    for (int k = 0; k < kMaxBands && (k == 0 || std::min(width, height) > 1); ++k) {
        Band band;
        for (Array2<float>* map :
             {&band.events, &band.rho, &band.rho_before, &band.known, &band.where,
              &band.where_before, &band.weight, &band.mean, &band.part, &band.sum})
            *map = Array2<float>(height, width);
        band.reach = kForgottenPerEvent / float(1 << k);
        bands_.push_back(std::move(band));
        width = (width + 1) / 2;
        height = (height + 1) / 2;
    }
    for (Band& band : bands_) band.share = 1 / float(bands_.size());
    reset();
}

void ResidualPyramid::reset() noexcept {
    for (Band& band : bands_) {
        for (Array2<float>* map : {&band.events, &band.known}) fill(*map, 0);
        for (Array2<float>* map : {&band.rho, &band.rho_before, &band.where, &band.where_before})
            fill(*map, 1);
    }
}

void ResidualPyramid::forget(const Array2<float>& events) noexcept {
    const Array2<float>* now = &events;
    for (std::size_t k = 0; k < bands_.size(); ++k) {
        Band& band = bands_[k];
        if (k > 0) halve(*now, band.sum);
        if (k > 0) now = &band.sum;
        for (std::size_t i = 0; i < band.events.values().size(); ++i)
            band.events.values()[i] += now->values()[i];
        copy(band.rho, band.rho_before);
        copy(band.where, band.where_before);
        band.fade();
    }
}

void ResidualPyramid::observe(const Array2<float>& trust, const Array2<float>& events) noexcept {
    for (std::size_t k = 0; k < bands_.size(); ++k) {
        Band& band = bands_[k];
        k == 0 ? copy(trust, band.sum) : halve(bands_[k - 1].sum, band.sum);
        for (std::size_t i = 0; i < band.known.values().size(); ++i) {
            const float sure = band.sum.values()[i];
            // u <- trust + (1 - trust) u rho: rho by the events since the image before, which are
            // replaced after this.
            band.known.values()[i] = mix(band.known.values()[i] * band.rho.values()[i], 1, sure);
        }
        k == 0 ? copy(events, band.events) : halve(bands_[k - 1].events, band.events);
        band.fade();
        copy(band.rho, band.rho_before);
        fill(band.where_before, 1);
    }
}

void ResidualPyramid::know(const Array2<float>& where) noexcept {
    for (std::size_t k = 0; k < bands_.size(); ++k)
        k == 0 ? copy(where, bands_[k].where) : halve(bands_[k - 1].where, bands_[k].where);
}

/// c_k = min(1, 4 w_k), c_0 = w_0, with w_k the mean of where the residual is known: what a band
/// may add to what those below it tell of around.
float ResidualPyramid::reach_of(std::size_t band, float where) {
    return std::min(1.F, (band == 0 ? 1.F : 4.F) * where);
}

/// m_k: mean of the residual over 2^k x 2^k px, weighted by where it is known, whose own mean is
/// w_k, linear in time as rho_k is; from the coarsest on
///
///     r_k = c_k (m_k - up(m'_{k+1})),    m'_k = up(m'_{k+1}) + r_k
///
///     correction = sum over k of up(rho_k r_k)
void ResidualPyramid::correct(const Array2<float>& residual, Array2<float>& correction,
                              float at) noexcept {
    for (Band& band : bands_)
        for (std::size_t i = 0; i < band.weight.values().size(); ++i)
            band.weight.values()[i] =
                mix(band.where_before.values()[i], band.where.values()[i], at);
    copy(residual, bands_.front().mean);
    for (std::size_t k = 1; k < bands_.size(); ++k) {
        Band &band = bands_[k], &finer = bands_[k - 1];
        for (std::size_t i = 0; i < finer.sum.values().size(); ++i)
            finer.sum.values()[i] = finer.mean.values()[i] * finer.weight.values()[i];
        halve(finer.sum, band.mean);
        for (std::size_t i = 0; i < band.mean.values().size(); ++i) {
            const float weight = band.weight.values()[i];
            band.mean.values()[i] /= weight > 0 ? weight : 1;
        }
    }
    for (std::size_t k = bands_.size(); k-- > 0;) {
        Band& band = bands_[k];
        const Band* coarser = k + 1 < bands_.size() ? &bands_[k + 1] : nullptr;
        fill(band.sum, 0);
        if (coarser) add_doubled(coarser->mean, band.sum);
        for (std::size_t i = 0; i < band.mean.values().size(); ++i) {
            const float around = band.sum.values()[i];
            band.part.values()[i] =
                reach_of(k, band.weight.values()[i]) * (band.mean.values()[i] - around);
            band.mean.values()[i] = around + band.part.values()[i];
        }
        Array2<float>& sum = k == 0 ? correction : band.sum;
        fill(sum, 0);
        if (coarser) add_doubled(coarser->sum, sum);
        for (std::size_t i = 0; i < sum.values().size(); ++i)
            sum.values()[i] +=
                mix(band.rho_before.values()[i], band.rho.values()[i], at) * band.part.values()[i];
    }
}

/// left = sum over k of up(s_k (1 - (u_k rho_k c_k)^2)).
void ResidualPyramid::variance(Array2<float>& left) noexcept {
    for (std::size_t k = bands_.size(); k-- > 0;) {
        Band& band = bands_[k];
        Array2<float>& sum = k == 0 ? left : band.sum;
        fill(sum, 0);
        if (k + 1 < bands_.size()) add_doubled(bands_[k + 1].sum, sum);
        for (std::size_t i = 0; i < sum.values().size(); ++i) {
            const float known =
                band.rho.values()[i] * band.known.values()[i] * reach_of(k, band.where.values()[i]);
            sum.values()[i] += band.share * (1 - known * known);
        }
    }
}

}  // namespace eventide
