// Maps of half the size, and back.
#include "src/model/render/half_maps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

namespace eventide {
namespace {

Array2<float> random_map(int width, int height) {
    std::mt19937 random{std::uint32_t(width * 1000 + height)};
    std::uniform_real_distribution<float> uniform{-1, 1};
    Array2<float> map(height, width);
    for (float& v : map.values()) v = uniform(random);
    return map;
}

/// Bilinear between the centres of blocks: fine pixel i lies at (i - .5) / 2, the edge's value
/// beyond.
double between(const Array2<float>& map, int y, int x) {
    const auto tap = [](int i, int size) {
        const int first = i / 2, second = i % 2 == 0 ? first - 1 : first + 1;
        return std::pair{first, std::clamp(second, 0, size - 1)};
    };
    const auto [a, b] = tap(y, map.height());
    const auto [c, d] = tap(x, map.width());
    const auto across = [&](int row) { return .75 * map(row, c) + .25 * map(row, d); };
    return .75 * across(a) + .25 * across(b);
}

TEST(HalfMaps, DoublingIsBilinearBetweenTheCentresOfBlocksAtAnySize) {
    for (const auto& [width, height] :
         {std::pair{1, 1}, {2, 1}, {1, 5}, {7, 4}, {63, 2}, {64, 2}, {65, 3}, {128, 1}, {130, 3}}) {
        const Array2<float> map = random_map(width, height);
        for (const int less : {0, 1}) {  // twice as large, and an odd size that was halved
            const Array2<float> before = random_map(2 * width - less, 2 * height - less);
            Array2<float> to(before.height(), before.width());
            copy(before, to);
            add_doubled(map, to);
            for (int y = 0; y < to.height(); ++y) {
                std::vector<float> row(std::size_t(to.width()), 1.F);
                add_doubled_row(map, y, row, -3);
                for (int x = 0; x < to.width(); ++x) {
                    ASSERT_NEAR(to(y, x), before(y, x) + between(map, y, x), 1e-6)
                        << width << 'x' << height << " less " << less << ": " << y << ' ' << x;
                    ASSERT_NEAR(row[std::size_t(x)], 1 - 3 * between(map, y, x), 1e-5);
                }
            }
        }
    }
}

TEST(HalfMaps, HalvingTakesMeansOfBlocksAndOfWhatIsLeftAtTheEdge) {
    for (const auto& [width, height] : {std::pair{1, 1}, {2, 2}, {5, 3}, {64, 48}}) {
        const Array2<float> map = random_map(width, height);
        Array2<float> half((height + 1) / 2, (width + 1) / 2);
        halve(map, half);
        for (int y = 0; y < half.height(); ++y)
            for (int x = 0; x < half.width(); ++x) {
                double sum = 0;
                int count = 0;
                for (int v = 2 * y; v < std::min(2 * y + 2, height); ++v)
                    for (int u = 2 * x; u < std::min(2 * x + 2, width); ++u, ++count)
                        sum += map(v, u);
                ASSERT_NEAR(half(y, x), sum / count, 1e-6) << width << 'x' << height;
            }
    }
}

}  // namespace
}  // namespace eventide
