// A feature map with a border of zeros, so that a 3x3 convolution needs no special case at edges.
#pragma once

#include "src/core/array.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <utility>

namespace eventide {

/// [y][x][channel], -1 <= y <= height, -1 <= x <= width. The border stays zero: nobody writes it.
///
///     at(-1, -1)  0 0 0 0 0      height 2, width 3: rows of (3 + 2) channels numbers each
///                 0 a b c 0      at(0, 0) is a
///                 0 d e f 0
///                 0 0 0 0 0
class PaddedMap {
public:
    PaddedMap() = default;
    /// `border`: pixels on each side.
    PaddedMap(int height, int width, int channels, int border = 1)
        : height_(height),
          width_(width),
          border_(border),
          padded_(height + 2 * border, width + 2 * border, channels) {}

    int height() const { return height_; }
    int width() const { return width_; }
    int channels() const { return padded_.channels(); }
    /// Numbers from one row to the next.
    std::ptrdiff_t pitch() const { return std::ptrdiff_t(width_ + 2 * border_) * channels(); }
    float* at(int y, int x) { return padded_.values().data() + place(y, x); }
    const float* at(int y, int x) const { return padded_.values().data() + place(y, x); }

    /// Trades numbers with an array of the same size; without a border.
    void exchange(Array3<float>& other) noexcept {
        assert(border_ == 0 && other.values().size() == padded_.values().size());
        std::swap(padded_, other);
    }

    void clear() { std::ranges::fill(padded_.values(), 0.0F); }
    /// `from` and `to` are [height][width][channels] without a border.
    void load(const float* from) {
        for (int y = 0; y < height_; ++y) std::memcpy(at(y, 0), from + y * row(), row_bytes());
    }
    void save(float* to) const {
        for (int y = 0; y < height_; ++y) std::memcpy(to + y * row(), at(y, 0), row_bytes());
    }

private:
    std::ptrdiff_t place(int y, int x) const {
        return (y + border_) * pitch() + (x + border_) * std::ptrdiff_t(channels());
    }
    std::ptrdiff_t row() const { return std::ptrdiff_t(width_) * channels(); }
    std::size_t row_bytes() const { return std::size_t(row()) * sizeof(float); }
    int height_ = 0, width_ = 0, border_ = 1;
    Array3<float> padded_;
};

}  // namespace eventide
