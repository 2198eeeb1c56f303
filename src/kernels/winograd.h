// 3x3 convolutions with half of the products: Winograd's minimal filtering F(4, 3) along rows.
#pragma once

#include <cstddef>

namespace eventide {

/// Four outputs beside each other, which read six pixels of each of three rows, take six products
/// a channel and row instead of twelve:
///
///     pixels          d0 d1 d2 d3 d4 d5      of a row
///     positions       v0 .. v5 = B d         6 sums of pixels: winograd_input
///     products        m_k = sum over rows and channels of u_k v_k, with u_k = G w of the taps w
///     outputs         y0 .. y3 = A m         4 sums of products: winograd_output
///
/// Positions 0 to 5 are the points 0, a, -a, b, -b and infinity of S. Winograd, "Arithmetic
/// Complexity of Computations" (1980); as layers of networks: A. Lavin, S. Gray, arXiv 1509.09308.
/// a = sqrt(1/2), b = sqrt(2): a b = 1 makes B's coefficients short, and rounding is a third of
/// what points 1 and 2 bring.
///
///     v0 = d0 - 5/2 d2 + d4                        u0 = w0
///     v1, v2 = (d4 - 2 d2) +- a (d3 - 2 d1)        u1, u2 = -2/3 (w0 +- a w1 + w2 / 2)
///     v3, v4 = (d4 - d2 / 2) +- b (d3 - d1 / 2)    u3, u4 = 1/6 (w0 +- b w1 + 2 w2)
///     v5 = d1 - 5/2 d3 + d5                        u5 = w2
///
///     y0 = m0 + (m1 + m2) + (m3 + m4)              y2 = (m1 + m2) / 2 + 2 (m3 + m4)
///     y1 = a (m1 - m2) + b (m3 - m4)               y3 = a / 2 (m1 - m2) + 2 b (m3 - m4) + m5
constexpr int kWinogradOutputs = 4, kWinogradPositions = 6, kWinogradTaps = 3;
constexpr double kWinogradA = 0.70710678118654752440, kWinogradB = 1.41421356237309504880;

/// v of rows of one source, [group][row][step] in each position's plane, so that what a product
/// sums up, three rows of all channels, lies one after the other.
/// Units of 4 bytes are float32 numbers, or pairs of bf16 numbers, which are summed up in float32.
struct WinogradInput {
    const void* in = nullptr;  ///< [row][pixel][channel]: up and left of the first output
    std::ptrdiff_t pitch = 0;  ///< units from one row to the next
    int rows = 0, pixels = 0;  ///< pixels past the last of a row are read as the last
    int channels = 0;
    void* out = nullptr;                 ///< of position 0, group 0, row 0
    std::ptrdiff_t plane = 0, step = 0;  ///< units from position to position, row to row
};

/// y = act(A m + bias) of rows of products, which lie [group][row][output] in each plane.
struct WinogradOutput {
    const float* in = nullptr;
    std::ptrdiff_t plane = 0;
    const float* bias = nullptr;  ///< [outputs]
    bool relu = false;
    int rows = 0, width = 0, outputs = 0;        ///< width: pixels of a row
    void* out = nullptr;                         ///< float32, or bf16 by the kernels that say so
    std::ptrdiff_t out_pitch = 0, out_step = 0;  ///< units between rows, pixels
};

}  // namespace eventide
