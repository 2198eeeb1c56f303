// A correction of frames, band by band, and how fast each band is forgotten as things move.
#pragma once

#include "src/core/array.h"

#include <vector>

namespace eventide {

/// How much of what a model's frames lacked when the sensor took an image still holds, band by band
/// of a Laplacian pyramid: band k holds structure of about 2^k px. Since then each band fades on
/// its own: where n events per pixel have come, the correlation with what is lacking now is taken
/// to be
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

    /// An image was taken: how far it can be trusted, 0 to 1, [y][x] of the sensor. `events`:
    /// events per pixel that have come since, which count as if forget() had been told.
    void observe(const Array2<float>& trust, const Array2<float>& events) noexcept;

    /// Where residuals are known at the end of the time that forget() told of last, 0 to 1;
    /// elsewhere the coarser bands of what is around go on. All of them, after reset().
    void know(const Array2<float>& where) noexcept;

    /// What to add to a frame that lacks `residual`; [y][x]. Not the same array. `at`: where in the
    /// time that forget() told of last, 1 at its end; an observe() after it counts for all of that.
    void correct(const Array2<float>& residual, Array2<float>& correction, float at = 1) noexcept;

    /// Which share of the model's variance is left at that end; [y][x].
    void variance(Array2<float>& left) noexcept;

private:
    static float reach_of(std::size_t band, float where);

    struct Band {
        Array2<float> events;                   // per pixel, since the image
        Array2<float> rho;                      // by these
        Array2<float> rho_before;               // and before the last of them
        Array2<float> known;                    // rho when the image was taken
        Array2<float> where;                    // residuals are known
        Array2<float> where_before;             // and were at the end of the time before
        Array2<float> weight, mean, part, sum;  // scratch of correct()
        float reach = 1;                        // a / 2^k
        float share = 0;                        // s_k
        void fade() noexcept;
    };
    std::vector<Band> bands_;
};

}  // namespace eventide
