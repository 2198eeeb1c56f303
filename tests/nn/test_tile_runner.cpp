// Work in two halves, group by group: what ConvGru's states rely on.
#include "src/nn/tile_runner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <utility>
#include <vector>

namespace eventide {
namespace {

/// What was done to which tile, in order of time.
struct Done {
    bool is_first = false;
    std::size_t tile = 0;
};

std::vector<Done> done_in_groups(const std::vector<Tile>& tiles, const Mask& where,
                                 std::size_t group, bool skip_quiet) {
    TileRunner runner{sequential_for, skip_quiet};
    runner.make_room(1, tiles.size());
    std::vector<Done> done;
    const auto note = [&](bool is_first) {
        return [&done, is_first](std::size_t i, const Tile&, float*) {
            done.push_back({is_first, i});
        };
    };
    runner.in_groups(tiles, where, group, note(true), note(false));
    return done;
}

/// Of groups n - 1, n and n + 1 first() has run where second() of group n begins, and never do more
/// than two groups wait for it.
void expect_order(const std::vector<Done>& done, const std::set<std::size_t>& active,
                  std::size_t group) {
    std::set<std::size_t> first, second;
    for (const Done& at : done) {
        EXPECT_TRUE(active.contains(at.tile)) << at.tile;
        EXPECT_TRUE((at.is_first ? first : second).insert(at.tile).second) << "once";
        if (at.is_first) {
            std::set<std::size_t> waiting;
            for (const std::size_t tile : first)
                if (!second.contains(tile)) waiting.insert(tile / group);
            EXPECT_LE(waiting.size(), 2U);
            // They share what holds them aside with every second group.
            EXPECT_LE(*waiting.rbegin() - *waiting.begin(), 1U);
        } else {
            for (const std::size_t tile : active)
                EXPECT_TRUE(tile / group > at.tile / group + 1 || first.contains(tile))
                    << tile << " before " << at.tile;
        }
    }
    EXPECT_EQ(first, active);
    EXPECT_EQ(second, active);
}

TEST(TileRunner, SecondHalvesFollowTheFirstOfAllGroupsBesideThem) {
    const std::vector<Tile> tiles = tiles_of(60, 40, 10);  // 24 tiles
    std::mt19937 random{5};
    for (const std::size_t group : {1, 3, 4, 7, 24, 100})
        for (int n = 0; n < 60; ++n) {
            Mask where{60, 40};
            std::set<std::size_t> active;
            for (std::size_t i = 0; i < tiles.size(); ++i)
                if (random() % 12 < unsigned(n % 13)) {  // from none to all
                    where(tiles[i].y1 - 1, tiles[i].x1 - 1) = 1;
                    active.insert(i);
                }
            expect_order(done_in_groups(tiles, where, group, true), active, group);
        }
}

TEST(TileRunner, WithoutSkippingEveryTileIsWorkedOn) {
    const std::vector<Tile> tiles = tiles_of(60, 40, 10);
    std::set<std::size_t> all;
    for (std::size_t i = 0; i < tiles.size(); ++i) all.insert(i);
    expect_order(done_in_groups(tiles, Mask{60, 40}, 3, false), all, 3);
    EXPECT_TRUE(done_in_groups(tiles, Mask{60, 40}, 3, true).empty());
}

/// What lies outside of a tile that is taken past its map's edge becomes zero, and nothing else.
TEST(TileRunner, OnlyWhatLiesOutsideIsCleared) {
    constexpr int kUnits = 2;
    const Tile map{0, 0, 5, 4};
    for (const Tile& tile : {Tile{0, 0, 5, 4}, {0, 0, 2, 2}, {3, 2, 5, 4}, {1, 1, 3, 3}}) {
        const Tile wide = tile.widened(2), inside = wide.within(map);
        const std::ptrdiff_t pitch = std::ptrdiff_t(wide.width()) * kUnits + 3;
        std::vector<float> numbers(std::size_t(wide.height() * pitch), 7);
        clear_outside(wide, inside, numbers.data(), pitch, kUnits);
        for (int y = wide.y0; y < wide.y1; ++y)
            for (std::ptrdiff_t i = 0; i < pitch; ++i) {
                const int x = wide.x0 + int(i / kUnits);
                const bool is_kept = x >= wide.x1 || (y >= inside.y0 && y < inside.y1 &&
                                                      x >= inside.x0 && x < inside.x1);
                EXPECT_EQ(numbers[std::size_t((y - wide.y0) * pitch + i)], is_kept ? 7 : 0)
                    << y << " " << x;
            }
    }
}

}  // namespace
}  // namespace eventide
