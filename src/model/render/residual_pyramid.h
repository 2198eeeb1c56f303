// A correction of frames, band by band, and how fast each band is forgotten as things move.
#pragma once

#include "src/core/array.h"

#include <vector>

namespace eventide {

void fill(Array2<float>& map, float value) noexcept;

/// Mean of each block of 2 x 2 pixels (of fewer at the edge): [h][w] -> [(h + 1) / 2][(w + 1) / 2].
void halve(const Array2<float>& from, Array2<float>& to) noexcept;

/// Bilinear between the centres of blocks, the edge's value beyond: adds to `to`, which is up to
/// twice as large.
void add_doubled(const Array2<float>& from, Array2<float>& to) noexcept;

/// What a model's frames lacked when the sensor took an image, as a Laplacian pyramid: band k
/// holds structure of about 2^k px. Since then each band fades on its own: where n events per pixel
/// have come, the correlation with what is lacking now is taken to be
///
///     rho_k = exp(-a n / 2^k),
///
/// for the scene has moved some 1/a px per event, and a band is of no use once it is displaced by
/// its own size. Where nothing happens, nothing is forgotten. As an autoregressive process has it,
/// what is expected is rho_k times the band, and of the share s_k of the model's variance that the
/// band is responsible for, 1 - rho_k^2 is left.
///
///     band, of 240x180    0          1         2        3        4        5       6
///     map                 240x180    120x90    60x45    30x23    15x12    8x6     4x3
///     a / 2^k, a = 2      2          1         1/2      1/4      1/8      1/16    1/32
class ResidualPyramid {
public:
    /// All memory is taken here.
    ResidualPyramid(int width, int height);

    void reset() noexcept;

    /// Time passes: events per pixel, [y][x].
    void forget(const Array2<float>& events) noexcept;

    /// A new residual, [y][x] of the sensor, and how far it can be trusted, 0 to 1. `events`:
    /// events per pixel that have come since, which count as if forget() had been told. Where it
    /// can't be trusted, `residual` should repeat what expect() said.
    void observe(const Array2<float>& residual, const Array2<float>& trust,
                 const Array2<float>& events) noexcept;

    /// What to add to a frame now, and which share of the model's variance is left; [y][x].
    void expect(Array2<float>& correction, Array2<float>& variance) noexcept;

private:
    struct Band {
        Array2<float> residual;   // of this band alone
        Array2<float> events;     // per pixel, since the residual was seen
        Array2<float> known;      // rho when it was seen
        Array2<float> sum, left;  // scratch
        float reach = 1;          // a / 2^k
        float share = 0;          // s_k
        float rho(std::size_t i) const;
    };
    std::vector<Band> bands_;
};

}  // namespace eventide
