// How rows of sums of products are cut into register blocks: the same for every kind of number.
#pragma once

#include <array>
#include <cstddef>

namespace eventide {

/// `one` and `two` hold a function for each number of pixels from 1 on, which sums one or two
/// vectors of outputs: block(rows, in, weight, first output, out). As few blocks as possible, of
/// about the same size; weights lie as pack_weights puts them.
template <typename Rows, typename Block, std::size_t kMaxOfOne, std::size_t kMaxOfTwo>
void dot_in_blocks(const Rows& r, int lanes, const std::array<Block, kMaxOfOne>& one,
                   const std::array<Block, kMaxOfTwo>& two) {
    auto weight = r.weight;
    for (int first = 0; first < r.outputs;) {
        const bool is_two = r.outputs - first > lanes;
        const int width = is_two ? 2 * lanes : lanes;
        const int most = int(is_two ? kMaxOfTwo : kMaxOfOne), parts = (r.pixels + most - 1) / most;
        for (int part = 0; part < parts; ++part) {
            const int begin = r.pixels * part / parts, end = r.pixels * (part + 1) / parts;
            const auto n = std::size_t(end - begin - 1);
            const Block block = is_two ? two[n] : one[n];
            block(r, r.in + begin * r.step, weight, first, r.out + begin * r.out_step + first);
        }
        weight += std::ptrdiff_t(r.stretches) * r.length * width;
        first += width;
    }
}

}  // namespace eventide
