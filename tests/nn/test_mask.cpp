// Masks against their definition.
#include "src/kernels/mask.h"
#include "src/nn/tiling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

namespace eventide {
namespace {

Mask random_mask(int height, int width, std::uint32_t seed) {
    Mask mask{height, width};
    std::mt19937 random{seed};
    for (auto& v : mask.values()) v = random() % 17 == 0;
    return mask;
}

bool any_near(const Mask& mask, int y, int x, int radius) {
    for (int j = std::max(0, y - radius); j <= std::min(mask.height() - 1, y + radius); ++j)
        for (int i = std::max(0, x - radius); i <= std::min(mask.width() - 1, x + radius); ++i)
            if (mask(j, i) != 0) return true;
    return false;
}

TEST(Mask, DilatingIsAnyWithinTheSquare) {
    for (const auto& [height, width] :
         std::vector<std::pair<int, int>>{{1, 1}, {1, 9}, {7, 1}, {13, 21}, {64, 3}})
        for (const int radius : {0, 1, 4, 30}) {
            const Mask mask = random_mask(height, width, 3);
            Mask scratch = mask, out = mask;
            dilate(out, radius, scratch);
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x)
                    EXPECT_EQ(out(y, x) != 0, any_near(mask, y, x, radius));
        }
}

TEST(Mask, HalvingIsTheMaximumAroundEverySecondPixel) {
    for (const auto& [height, width] :
         std::vector<std::pair<int, int>>{{1, 1}, {2, 9}, {7, 4}, {13, 22}}) {
        const Mask mask = random_mask(height, width, 5);
        Mask half{(height + 1) / 2, (width + 1) / 2};
        halve(mask, half);
        for (int y = 0; y < half.height(); ++y)
            for (int x = 0; x < half.width(); ++x)
                EXPECT_EQ(half(y, x) != 0, any_near(mask, 2 * y, 2 * x, 1));
    }
}

TEST(Mask, DoublingReachesEveryPixelThatASampleIsReadFor) {
    for (const auto& [height, width] :
         std::vector<std::pair<int, int>>{{1, 1}, {2, 9}, {7, 4}, {13, 22}, {14, 21}}) {
        const Mask mask = random_mask(height, width, 7);
        const Mask below = random_mask((height + 1) / 2, (width + 1) / 2, 11);
        Mask out{height, width};
        join_doubled(mask, below, out);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                bool expected = mask(y, x) != 0;
                for (const int sy : {y / 2, std::min((y + 1) / 2, below.height() - 1)})
                    for (const int sx : {x / 2, std::min((x + 1) / 2, below.width() - 1)})
                        expected |= below(sy, sx) != 0;
                EXPECT_EQ(out(y, x) != 0, expected) << y << " " << x;
            }
    }
}

TEST(Mask, GroupsOfATilesRowsAreFilledWhereOnePixelIsSet) {
    const std::vector<Tile> tiles = tiles_of(2, 13, 7);  // columns 0 to 5 and 6 to 12
    Mask mask{2, 13};
    mask(0, 5) = mask(0, 6) = mask(1, 12) = 1;
    fill_groups(mask, tiles, 4);
    const auto row = [&](int y) {
        std::string text;
        for (const std::uint8_t v : mask.row(y)) text += v != 0 ? '1' : '.';
        return text;
    };
    EXPECT_EQ(row(0), "....111111...")
        << "4 and 5 end the first tile's row, 6 to 9 begin the second";
    EXPECT_EQ(row(1), "..........111");
}

}  // namespace
}  // namespace eventide
