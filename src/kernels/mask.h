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

/// to[x] |= from[x + shift], as far as both are there
inline void join_row(std::span<const std::uint8_t> from, int shift, std::span<std::uint8_t> to) {
    const int n = int(to.size());
    const std::uint8_t* read = from.data() + shift;
    std::uint8_t* write = to.data();
    const int begin = std::max(0, -shift), end = std::min(n, n - shift);
    for (int x = begin; x < end; ++x) write[x] |= read[x];
}

/// out = 1 where `in` has a 1 within the (2 radius + 1)^2 square around the pixel. `scratch` has
/// the size of `in`; `out` may be `in`. Rows without a 1 cost next to nothing.
inline void dilate(const Mask& in, int radius, Mask& scratch, Mask& out) {
    const int height = in.height();
    for (int y = 0; y < height; ++y) {
        std::ranges::copy(in.row(y), scratch.row(y).begin());
        if (!any_in_row(in, y)) continue;
        for (int d = 1; d <= radius; ++d) {
            join_row(in.row(y), -d, scratch.row(y));
            join_row(in.row(y), d, scratch.row(y));
        }
    }
    for (int y = 0; y < height; ++y) std::ranges::fill(out.row(y), std::uint8_t{0});
    for (int y = 0; y < height; ++y) {
        if (!any_in_row(scratch, y)) continue;
        for (int to = std::max(0, y - radius); to <= std::min(y + radius, height - 1); ++to)
            join_row(scratch.row(y), 0, out.row(to));
    }
}

/// m_{l+1}: the 3x3 maximum at every second pixel. `out` has half the size of `in`, rounded up.
inline void halve(const Mask& in, Mask& out) {
    for (int y = 0; y < out.height(); ++y) {
        std::ranges::fill(out.row(y), std::uint8_t{0});
        for (int sy = std::max(0, 2 * y - 1); sy <= std::min(2 * y + 1, in.height() - 1); ++sy) {
            if (!any_in_row(in, sy)) continue;
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
    for (int y = 0; y < mask.height(); ++y) {
        std::ranges::copy(mask.row(y), out.row(y).begin());
        for (const int from : {y / 2, std::min((y + 1) / 2, below.height() - 1)}) {
            if (!any_in_row(below, from)) continue;
            for (int x = 0; x < mask.width(); ++x)
                out(y, x) |= std::uint8_t(below(from, x / 2) |
                                          below(from, std::min((x + 1) / 2, below.width() - 1)));
        }
    }
}

}  // namespace eventide
