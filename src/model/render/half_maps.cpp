// Maps of half the size, and back.
#include "src/model/render/half_maps.h"

#include <algorithm>
#include <array>

namespace eventide {

void copy(const Array2<float>& from, Array2<float>& to) noexcept {
    std::ranges::copy(from.values(), to.values().begin());
}

void fill(Array2<float>& map, float value) noexcept {
    std::ranges::fill(map.values(), value);
}

void halve(const Array2<float>& from, Array2<float>& to) noexcept {
    const auto pairs = std::size_t(from.width() / 2);
    for (int y = 0; y < to.height(); ++y) {
        const auto upper = from.row(2 * y),
                   lower = from.row(std::min(2 * y + 1, from.height() - 1));
        const auto out = to.row(y);
        for (std::size_t x = 0; x < pairs; ++x)
            out[x] = .25F * (upper[2 * x] + upper[2 * x + 1] + lower[2 * x] + lower[2 * x + 1]);
        if (out.size() > pairs) out[pairs] = .5F * (upper[2 * pairs] + lower[2 * pairs]);
    }
}

/// Where fine pixels lie between coarse ones: .75 and .25.
///
///     fine      0     1     2     3     4     5
///     coarse       0           1           2         fine 1: .75 of 0, .25 of 1
void add_doubled_row(const Array2<float>& from, int y, std::span<float> to, float times) noexcept {
    const int near = y / 2, other = y % 2 == 0 ? near - 1 : near + 1;
    const auto a = from.row(near), b = from.row(std::clamp(other, 0, from.height() - 1));
    const auto between = [&](std::size_t x) { return mix(a[x], b[x], .25F); };
    // A stretch of what lies between the two rows, with a neighbour on either side.
    constexpr std::size_t kStretch = 64;
    std::array<float, kStretch + 2> row;
    for (std::size_t begin = 0; begin < a.size(); begin += kStretch) {
        const std::size_t count = std::min(kStretch, a.size() - begin);
        row[0] = between(begin > 0 ? begin - 1 : 0);
        for (std::size_t i = 0; i < count; ++i) row[i + 1] = between(begin + i);
        row[count + 1] = between(std::min(begin + count, a.size() - 1));
        const auto out = to.subspan(2 * begin);
        const std::size_t pairs = std::min(count, out.size() / 2);
        for (std::size_t i = 0; i < pairs; ++i) {
            out[2 * i] += times * mix(row[i + 1], row[i], .25F);
            out[2 * i + 1] += times * mix(row[i + 1], row[i + 2], .25F);
        }
        if (pairs < count) out[2 * pairs] += times * mix(row[pairs + 1], row[pairs], .25F);
    }
}

void add_doubled(const Array2<float>& from, Array2<float>& to) noexcept {
    for (int y = 0; y < to.height(); ++y) add_doubled_row(from, y, to.row(y));
}

}  // namespace eventide
