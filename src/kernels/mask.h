// Where something happened: masks of 0 and 1 per pixel, which say what a recurrent step may leave
// out.
#pragma once

#include "src/core/array.h"

#include <algorithm>
#include <cstdint>
#include <span>

namespace eventide {

/// [y][x], 0 or 1
using Mask = Array2<std::uint8_t>;

/// out = 1 where `in` has a 1 within the (2 radius + 1)^2 square around the pixel. `scratch` has
/// the size of `in`; `out` may be `in`.
inline void dilate(const Mask& in, int radius, Mask& scratch, Mask& out) {
    const int height = in.height(), width = in.width();
    const auto spread = [radius](int n, auto read, auto write) {
        int last = -radius - 1;  // where the last 1 was seen
        int written = 0;
        for (int i = 0; i < n; ++i) {
            if (read(i) != 0) last = i;
            // Pixel i - radius sees up to i.
            if (i - radius >= 0) write(written++, last >= i - 2 * radius);
        }
        for (; written < n; ++written) write(written, last >= written - radius);
    };
    for (int y = 0; y < height; ++y)
        spread(
            width, [&](int x) { return in(y, x); },
            [&](int x, bool v) { scratch(y, x) = std::uint8_t(v); });
    for (int x = 0; x < width; ++x)
        spread(
            height, [&](int y) { return scratch(y, x); },
            [&](int y, bool v) { out(y, x) = std::uint8_t(v); });
}

/// m_{l+1}: the 3x3 maximum at every second pixel. `out` has half the size of `in`, rounded up.
inline void halve(const Mask& in, Mask& out) {
    for (int y = 0; y < out.height(); ++y)
        for (int x = 0; x < out.width(); ++x) {
            std::uint8_t any = 0;
            for (int sy = std::max(0, 2 * y - 1); sy <= std::min(2 * y + 1, in.height() - 1); ++sy)
                for (int sx = std::max(0, 2 * x - 1); sx <= std::min(2 * x + 1, in.width() - 1);
                     ++sx)
                    any |= in(sy, sx);
            out(y, x) = any;
        }
}

}  // namespace eventide
