// Sums of products for layers of 8 or 16 outputs with AVX-512: four pixels x four outputs in a
// register.
#pragma once

#include "src/kernels/dot_area.h"

namespace eventide::avx512 {

/// Inputs go by quads of units (four float32 numbers, or four pairs of bf16 numbers), one of each
/// of four pixels in a register, so that a unit of all four is spread by a shuffle and not by four
/// loads:
///
///     input      p0: u0 u1 u2 u3   p1: u0 u1 u2 u3   p2: u0 u1 u2 u3   p3: u0 u1 u2 u3
///     unit 1     p0: u1 u1 u1 u1   p1: u1 u1 u1 u1   p2: u1 u1 u1 u1   p3: u1 u1 u1 u1
///     weights    w0 w1 w2 w3       the same four times
///     sums       p0: o0 o1 o2 o3   p1: o0 o1 o2 o3   p2: o0 o1 o2 o3   p3: o0 o1 o2 o3
///
/// Whether an area can be done so: 8 or 16 outputs one after the other, whole quads, at least four
/// pixels a row.
bool takes_quads(const DotArea& area);

/// As VectorKernels::dot_area and Bf16Kernels::dot_area, with the same bits, of areas that
/// takes_quads() is true of. For processors that have AVX-512 (and AVX512_BF16) alone.
void dot_quads_f32(const DotArea& area);
void dot_quads_bf16(const DotArea& area);

/// Pixels of a map in several, `size` channels in each and zeros beyond the last, so that layers
/// read quads where they lie.
///
///     in       c0 .. c20 | c0 .. c20 | ...        21 channels
///     map 0    c0 .. c7  | c0 .. c7  | ...        maps of 8; one starts `plane` after the other
///     map 1    c8 .. c15 | c8 .. c15 | ...
///     map 2    c16 .. c20 0 0 0 | ...
struct SplitRow {
    const float* in = nullptr;  ///< [pixels][channels], channels <= size maps
    int pixels = 0, channels = 0, size = 0, maps = 0;
    void* out = nullptr;       ///< [pixels][size] in the first map
    std::ptrdiff_t plane = 0;  ///< units of 4 bytes from one map to the next
};
void split_pixels(const SplitRow& row);  ///< float32; size 4 or 8. For bf16 see CompressRow.

}  // namespace eventide::avx512
