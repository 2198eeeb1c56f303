// Convolution and up-sampling as docs/model.md defines them, for float and double: the judge of the
// fast kernels.
#pragma once

#include "src/core/array.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <vector>

namespace eventide::plain {

template <typename T>
struct ConvWeights {
    int out = 0, in = 0;
    std::vector<T> weight;  ///< [out][in][side][side]
    std::vector<T> bias;    ///< [out]
    int side = 3;           ///< 3 or 1
};

/// out[y][x][o] = bias[o] + sum of weight[o][i][dy][dx] in[stride y + dy][stride x + dx][i]
/// Zeros outside. Output j is centred on input stride j; n inputs give (n + stride - 1) /
/// stride.
template <typename T>
Array3<T> conv(const ConvWeights<T>& weights, const Array3<T>& in, int stride = 1) {
    assert(in.channels() == weights.in);
    const int side = weights.side, reach = side / 2;
    Array3<T> out{(in.height() + stride - 1) / stride, (in.width() + stride - 1) / stride,
                  weights.out};
    for (int y = 0; y < out.height(); ++y)
        for (int x = 0; x < out.width(); ++x)
            for (int o = 0; o < weights.out; ++o) {
                T sum = weights.bias[std::size_t(o)];
                for (int dy = -reach; dy <= reach; ++dy)
                    for (int dx = -reach; dx <= reach; ++dx) {
                        const int sy = stride * y + dy, sx = stride * x + dx;
                        if (sy < 0 || sy >= in.height() || sx < 0 || sx >= in.width()) continue;
                        const auto pixel = in.pixel(sy, sx);
                        const int tap = side * (dy + reach) + dx + reach;
                        for (int i = 0; i < weights.in; ++i)
                            sum +=
                                weights
                                    .weight[std::size_t((o * weights.in + i) * side * side + tap)] *
                                pixel[std::size_t(i)];
                    }
                out(y, x, o) = sum;
            }
    return out;
}

/// Channels of all maps, one after the other.
template <typename T>
Array3<T> join(const std::vector<const Array3<T>*>& maps) {
    int channels = 0;
    for (const Array3<T>* map : maps) channels += map->channels();
    Array3<T> out{maps[0]->height(), maps[0]->width(), channels};
    for (int y = 0; y < out.height(); ++y)
        for (int x = 0; x < out.width(); ++x) {
            auto to = out.pixel(y, x).begin();
            for (const Array3<T>* map : maps) {
                const auto from = map->pixel(y, x);
                to = std::copy(from.begin(), from.end(), to);
            }
        }
    return out;
}

/// Bilinear to height x width, where a has half of it, rounded up: out[2 j] = a[j].
template <typename T>
Array3<T> up2(const Array3<T>& a, int height, int width) {
    assert(a.height() == (height + 1) / 2 && a.width() == (width + 1) / 2);
    Array3<T> out{height, width, a.channels()};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            // Even rows and columns take the same sample twice: (s + s) / 2 is s.
            const int y0 = y / 2, y1 = std::min((y + 1) / 2, a.height() - 1);
            const int x0 = x / 2, x1 = std::min((x + 1) / 2, a.width() - 1);
            for (int c = 0; c < a.channels(); ++c)
                out(y, x, c) = (a(y0, x0, c) + a(y0, x1, c) + a(y1, x0, c) + a(y1, x1, c)) / 4;
        }
    return out;
}

}  // namespace eventide::plain
