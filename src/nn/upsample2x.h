// up2 of docs/model.md: a map brought to twice its size.
#pragma once

#include "src/kernels/vector_kernels.h"
#include "src/nn/padded_map.h"

#include <algorithm>

namespace eventide {

/// Row y of up2(below), columns x0 <= x < x1: the first pixel at `to`, `step` numbers to the next.
inline void double_row(const PaddedMap& below, int y, int x0, int x1, float* to,
                       std::ptrdiff_t step) noexcept {
    const int above = y / 2, under = std::min((y + 1) / 2, below.height() - 1);
    for (int x = x0; x < x1; ++x, to += step) {
        const int left = x / 2, right = std::min((x + 1) / 2, below.width() - 1);
        vector_kernels().average(below.at(above, left), below.at(above, right),
                                 below.at(under, left), below.at(under, right), to,
                                 below.channels());
    }
}

}  // namespace eventide
