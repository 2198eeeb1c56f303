// Which tiles are computed, by whom, and how often.
#include "src/nn/tiling.h"

#include <gtest/gtest.h>

#include <numeric>
#include <thread>
#include <vector>

namespace eventide {
namespace {

void backwards(int n, const std::function<void(int)>& body) {
    for (int i = n; i-- > 0;) body(i);
}

void on_threads(int n, const std::function<void(int)>& body) {
    std::vector<std::jthread> threads;
    for (int i = 0; i < n; ++i) threads.emplace_back([&body, i] { body(i); });
}

TEST(Tiling, TilesCoverTheMapAndAreNoLongerThanTheySay) {
    for (const int side : {1, 3, 7, 12, 16, 24, 32, 48})
        for (int width = 1; width <= 700; ++width) {
            int x = 0;
            for (const Tile& tile : tiles_of(1, width, side)) {
                ASSERT_EQ(tile.x0, x);
                ASSERT_GT(tile.width(), 0) << width;
                ASSERT_LE(tile.width(), side) << width;
                ASSERT_TRUE(side % 4 != 0 || x % 4 == 0) << "where a cache line begins";
                x = tile.x1;
            }
            ASSERT_EQ(x, width);
        }
}

TEST(Tiling, EachTileIsComputedOnceWhoeverComputesIt) {
    for (const ParallelFor& parallel_for :
         {ParallelFor{sequential_for}, ParallelFor{backwards}, ParallelFor{on_threads}})
        for (const int n : {0, 1, 2, 15, 16, 17, 20, 300}) {
            std::vector<std::atomic<int>> times(std::size_t(n) + 1);
            for_each_tile(parallel_for, n, [&](int worker, int i) {
                EXPECT_LT(worker, kWorkers);
                ++times[std::size_t(i)];
            });
            for (std::size_t i = 0; i < std::size_t(n); ++i) EXPECT_EQ(times[i], 1) << i;
            EXPECT_EQ(times[std::size_t(n)], 0);
        }
}

TEST(Tiling, AWorkerBeginsAtTheSamePartOfAMapWhateverItIsCutInto) {
    for (const int n : {16, 20, 48, 301})
        for (int worker = 0; worker < kWorkers; ++worker) {
            TileShares shares{n};
            int first = -1;
            shares.work(worker, [&](int i) { first = first < 0 ? i : first; });
            EXPECT_EQ(first, n * worker / kWorkers);
        }
}

TEST(Tiling, AWorkerThatIsDoneHelpsTheOthers) {
    TileShares shares{20};
    std::vector<int> tiles;
    shares.work(8, [&](int i) { tiles.push_back(i); });
    std::vector<int> all(20);
    std::iota(all.begin(), all.end(), 10);  // its own stretch, those behind it, those before it
    for (int& i : all) i %= 20;
    EXPECT_EQ(tiles, all);
    shares.work(3, [&](int) { ADD_FAILURE() << "nothing is left"; });
}

}  // namespace
}  // namespace eventide
