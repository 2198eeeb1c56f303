// up2 of docs/model.md: a map brought to twice its size.
#pragma once

#include "src/nn/numbers.h"
#include "src/nn/padded_map.h"

#include <algorithm>

namespace eventide {

/// Row y of up2(below), columns x0 <= x < x1, of so many channels: the first pixel at `to`, the
/// others behind it. Both are of the numbers that layers read.
///
///     y        0  1  2  3  4  5        below: 3 rows
///     above    0  0  1  1  2  2
///     under    0  1  1  2  2  2
inline void double_row(const PaddedMap& below, const Numbers& numbers, int channels, int y, int x0,
                       int x1, float* to) noexcept {
    const int above = y / 2, under = std::min((y + 1) / 2, below.height() - 1);
    numbers.double_row(
        {below.at(above, 0), below.at(under, 0), below.width() - 1, x0, x1, channels, to});
}

}  // namespace eventide
