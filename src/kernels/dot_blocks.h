// How sums of products are cut into register blocks: the same for every kind of number.
#pragma once

#include "src/kernels/dot_area.h"

#include <array>
#include <cstddef>

namespace eventide {

/// `one` and `two` hold a function for each number of pixels from 1 on, which sums one or two
/// vectors of outputs: block(area, weight, y, x, first output). As few blocks as possible, of about
/// the same size; weights lie in the order of packed_size().
///
///     outputs ->   0 .. 2 L-1   2 L .. 3 L-1        L: lanes of a vector
///     pixels       [ block of two ] [ of one ]      a block's sums stay in registers
///       |          [              ] [        ]      over all stretches
template <typename Number, typename Block, std::size_t kMaxOfOne, std::size_t kMaxOfTwo>
void dot_in_blocks(const DotArea& r, int lanes, const std::array<Block, kMaxOfOne>& one,
                   const std::array<Block, kMaxOfTwo>& two) {
    std::ptrdiff_t length = 0;
    for (int s = 0; s < r.count; ++s) length += r.stretches[s].length;
    const auto* weight = static_cast<const Number*>(r.weight);
    for (int first = 0; first < r.outputs;) {
        // Of 40 outputs and 16 lanes: two vectors from 0 on, then one from 32 on.
        const bool is_two = r.outputs - first > lanes;
        const Block* blocks = is_two ? two.data() : one.data();
        // Of 40 pixels in blocks of at most 14: 3 parts, size 13, 1 larger: 14 + 13 + 13.
        const int most = int(is_two ? kMaxOfTwo : kMaxOfOne), parts = (r.width + most - 1) / most;
        const int size = parts > 0 ? r.width / parts : 0, larger = r.width - size * parts;
        for (int y = 0; y < r.height; ++y)
            for (int part = 0, x = 0; part < parts; ++part) {
                const int pixels = size + int(part < larger);
                blocks[pixels - 1](r, weight, y, x, first);
                x += pixels;
            }
        // All blocks of pixels read the same length x width weights; behind them lie those of the
        // next outputs.
        const int width = is_two ? 2 * lanes : lanes;
        weight += length * width;
        first += width;
    }
}

}  // namespace eventide
