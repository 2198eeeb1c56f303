// Rows of tables on disk, found by bisection.
#pragma once

#include <cstdint>

namespace eventide {

/// The first of `rows` rows for which `before(row)` is false, where it is true up to there and
/// false from there on; `rows` where it is true for all. (Of std::ranges::partition_point over an
/// iota view clang 14 knows nothing.)
template <typename Before>
std::uint64_t partition_row(std::uint64_t rows, Before before) {
    std::uint64_t first = 0;
    while (rows > 0) {
        const std::uint64_t half = rows / 2;
        if (before(first + half)) {
            first += half + 1;
            rows -= half + 1;
        } else {
            rows = half;
        }
    }
    return first;
}

}  // namespace eventide
