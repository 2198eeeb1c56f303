// Where something happened: masks of 0 and 1 per pixel, which say what a recurrent step may leave
// out.
#pragma once

#include "src/core/array.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>

namespace eventide {

/// [y][x], 0 or 1
using Mask = Array2<std::uint8_t>;

inline bool any_in_row(const Mask& mask, int y) {
    return std::memchr(mask.row(y).data(), 1, mask.row(y).size()) != nullptr;
}

inline bool all_in_row(const Mask& mask, int y) {
    return std::memchr(mask.row(y).data(), 0, mask.row(y).size()) == nullptr;
}

/// to[i] |= from[i] of n numbers, eight at a time; from the last to the first where `backwards`, so
/// that either may lie behind or before the other.
inline void join_bytes(const std::uint8_t* from, std::uint8_t* to, int n, bool backwards) {
    const auto join8 = [&](int i) {
        std::uint64_t a, b;
        std::memcpy(&a, from + i, 8);
        std::memcpy(&b, to + i, 8);
        b |= a;
        std::memcpy(to + i, &b, 8);
    };
    const int whole = n / 8 * 8;
    if (backwards)
        for (int i = n - 1; i >= whole; --i) to[i] |= from[i];
    for (int i = 0; i < whole; i += 8) join8(backwards ? whole - 8 - i : i);
    if (!backwards)
        for (int i = whole; i < n; ++i) to[i] |= from[i];
}

/// Calls step(shift) so that what joined with itself, shifted so, again and again reaches `radius`
/// further.
/// Radius 12: shifts of 1, 2, 4 and 5 cover 2, 4, 8 and 13 pixels, itself included.
template <typename Step>
void reach(int radius, Step step) {
    for (int covered = 1; covered < radius + 1;) {
        const int shift = std::min(covered, radius + 1 - covered);
        step(shift);
        covered += shift;
    }
}

/// 1 where the mask has a 1 within the (2 radius + 1)^2 square around the pixel. `scratch` has its
/// size. First rows, then columns: one copy reaches to the right (down), one to the left (up),
/// doubling with each step.
///
///     mask         0 0 0 0 1 0 0 0 0
///     right        0 0 0 0 1 1 1 0 0      radius 2
///     left         0 0 1 1 1 0 0 0 0
///     both         0 0 1 1 1 1 1 0 0
inline void dilate(Mask& mask, int radius, Mask& scratch) {
    const int height = mask.height(), width = mask.width();
    for (int y = 0; y < height; ++y) {
        std::uint8_t *right = scratch.row(y).data(), *left = mask.row(y).data();
        std::ranges::copy(mask.row(y), right);
        if (!any_in_row(mask, y)) continue;
        reach(std::min(radius, width - 1), [&](int shift) {
            join_bytes(right, right + shift, width - shift, true);
            join_bytes(left + shift, left, width - shift, false);
        });
        join_bytes(left, right, width, false);
    }
    std::ranges::copy(scratch.values(), mask.values().begin());
    reach(std::min(radius, height - 1), [&](int shift) {
        for (int y = height - 1; y >= shift; --y)
            join_bytes(scratch.row(y - shift).data(), scratch.row(y).data(), width, false);
        for (int y = 0; y + shift < height; ++y)
            join_bytes(mask.row(y + shift).data(), mask.row(y).data(), width, false);
    });
    join_bytes(scratch.values().data(), mask.values().data(), int(mask.values().size()), false);
}

/// out[y][x] = max of in[2 y - 1 .. 2 y + 1][2 x - 1 .. 2 x + 1], as far as they are there. That is
/// m_{l+1}: the 3x3 maximum at every second pixel. `out` has half the size of `in`, rounded up.
inline void halve(const Mask& in, Mask& out) {
    for (int y = 0; y < out.height(); ++y) {
        std::ranges::fill(out.row(y), std::uint8_t{0});
        for (int sy = std::max(0, 2 * y - 1); sy <= std::min(2 * y + 1, in.height() - 1); ++sy) {
            if (!any_in_row(in, sy)) continue;
            if (all_in_row(in, sy)) {
                std::ranges::fill(out.row(y), std::uint8_t{1});
                break;
            }
            const auto from = in.row(sy);
            for (int x = 0; x < out.width(); ++x) {
                const int first = std::max(0, 2 * x - 1),
                          last = std::min(2 * x + 1, in.width() - 1);
                for (int sx = first; sx <= last; ++sx) out(y, x) |= from[std::size_t(sx)];
            }
        }
    }
}

/// out = 1 where `mask` has a 1, or any of the samples of `below`, of half the size, that up2
/// makes the pixel of (docs/model.md).
inline void join_doubled(const Mask& mask, const Mask& below, Mask& out) {
    const int width = mask.width(), last = below.width() - 1;
    for (int y = 0; y < mask.height(); ++y) {
        std::ranges::copy(mask.row(y), out.row(y).begin());
        if (all_in_row(mask, y)) continue;
        const int above = y / 2, under = std::min((y + 1) / 2, below.height() - 1);
        if (!any_in_row(below, above) && !any_in_row(below, under)) continue;
        std::uint8_t* const row = out.row(y).data();
        const auto either = [upper = below.row(above).data(), lower = below.row(under).data()](
                                int x) { return std::uint8_t(upper[x] | lower[x]); };
        // Sample by sample, for the two pixels that it is left of: the one on it, and the one
        // before the next.
        std::uint8_t left = either(0);
        for (int x = 0; x < width; x += 2) {
            const std::uint8_t right = either(std::min(x / 2 + 1, last));
            row[x] |= left;
            if (x + 1 < width) row[x + 1] |= std::uint8_t(left | right);
            left = right;
        }
    }
}

}  // namespace eventide
