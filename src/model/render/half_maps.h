// Maps of half the size, and back.
#pragma once

#include "src/core/array.h"

#include <span>

namespace eventide {

/// Between two numbers: a at 0, b at 1.
inline float mix(float a, float b, float weight) {
    return a + weight * (b - a);
}

void fill(Array2<float>& map, float value) noexcept;

/// Both are of the same size.
void copy(const Array2<float>& from, Array2<float>& to) noexcept;

/// Mean of each block of 2 x 2 pixels (of fewer at the edge): [h][w] -> [(h + 1) / 2][(w + 1) / 2].
void halve(const Array2<float>& from, Array2<float>& to) noexcept;

/// Bilinear between the centres of blocks, the edge's value beyond: adds to `to`, which is up to
/// twice as large.
void add_doubled(const Array2<float>& from, Array2<float>& to) noexcept;

/// Row y of that, so many times.
void add_doubled_row(const Array2<float>& from, int y, std::span<float> to,
                     float times = 1) noexcept;

}  // namespace eventide
