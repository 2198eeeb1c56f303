// What the renderer does around its hidden layers, for a block of pixels of one row.
#pragma once

#include <cstddef>

namespace eventide {

/// The first layer of the renderer's network, where its convolution is known:
/// out[p][n] = max(0, sums[column[p] width + n] + base[n] + dx[p] slope[n])
/// `sums` and `out` are of the numbers that layers read, pixels one after the other.
/// base, slope: [width]. As `ahead` the renderer gives the way to the sample below.
struct OffsetRows {
    const void* sums = nullptr;
    std::ptrdiff_t ahead = 0;     ///< units from here to sums wanted soon; 0: none
    const int* column = nullptr;  ///< [pixels] which pixel of `sums`
    const float* dx = nullptr;    ///< [pixels]
    const float* base = nullptr;
    const float* slope = nullptr;
    int pixels = 0, width = 0;  ///< width: n
    void* out = nullptr;        ///< [pixels][width]
};

/// The network's last layer: first[p] = bias[0] + weight[0] . in[p], second[p] with 1; `weight` is
/// [2][width].
struct TwoOutputs {
    const float* in = nullptr;  ///< [pixels][width]
    const float* weight = nullptr;
    const float* bias = nullptr;
    int pixels = 0, width = 0;
    float *first = nullptr, *second = nullptr;  ///< [pixels]
};

/// The first layer's offsets, one hidden layer and the last of two outputs at once.
///
///     relu(sums[column[p]] + base + dx[p] slope)      pixels x offset.width
///     relu(hidden weights . that + bias)              pixels x outputs
///     last weights . that + last bias                 pixels x 2: mu, log_sigma
struct HiddenRows {
    OffsetRows offset;             ///< `out` is not used
    const void* weight = nullptr;  ///< of the hidden layer, as dot_area reads them
    const float* bias = nullptr;   ///< [outputs rounded up to whole vectors]
    int outputs = 0;
    const float *last_weight = nullptr, *last_bias = nullptr;  ///< [2][outputs], [2]
    float *mu = nullptr, *log_sigma = nullptr;                 ///< [pixels]
};

/// What a sample adds to the pixels around it, in place: with w = weight share[p],
/// mu <- w mu, log_sigma <- w s with s = log_sigma within its limits, square <- w (exp(2 s) +
/// mu^2).
struct WeighRows {
    float *mu = nullptr, *log_sigma = nullptr;  ///< [pixels]
    float* square = nullptr;                    ///< [pixels], or null
    const float* share = nullptr;               ///< [pixels]
    float weight = 0, least = 0, most = 0;      ///< least, most: of log_sigma
    int pixels = 0;
};

}  // namespace eventide
