// Maps cut into tiles, and tiles handed to whoever has threads.
#pragma once

#include "src/core/parallel_for.h"
#include "src/kernels/mask.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <vector>

namespace eventide {

/// A rectangle of a map: rows y0 <= y < y1, columns x0 <= x < x1.
struct Tile {
    int y0 = 0, x0 = 0, y1 = 0, x1 = 0;

    int height() const { return y1 - y0; }
    int width() const { return x1 - x0; }
    /// Larger by n on each side, within a map of height x width.
    Tile grown(int n, int map_height, int map_width) const {
        return {std::max(y0 - n, 0), std::max(x0 - n, 0), std::min(y1 + n, map_height),
                std::min(x1 + n, map_width)};
    }
    /// Larger by n on each side, past the map's edges, too.
    Tile widened(int n) const { return {y0 - n, x0 - n, y1 + n, x1 + n}; }
    Tile within(const Tile& other) const {
        return {std::max(y0, other.y0), std::max(x0, other.x0), std::min(y1, other.y1),
                std::min(x1, other.x1)};
    }
    bool any(const Mask& mask) const {
        for (int y = y0; y < y1; ++y)
            if (std::memchr(&mask(y, x0), 1, std::size_t(width())) != nullptr) return true;
        return false;
    }
};

/// Zeros in what of `wide` lies outside `inside`. Its first pixel is at `out`, `pitch` numbers from
/// one row to the next, `units` a pixel.
///
///     0 0 0 0 0      wide: 4 x 5, of which `inside` (i) is 3 x 4, as of a tile in the upper left
///     0 i i i i      corner; what is inside stays as it is, and its caller writes it
///     0 i i i i
///     0 i i i i
inline void clear_outside(const Tile& wide, const Tile& inside, float* out, std::ptrdiff_t pitch,
                          std::ptrdiff_t units) {
    const auto clear = [&](int y, int x0, int x1) {
        float* from = out + (y - wide.y0) * pitch + (x0 - wide.x0) * units;
        std::fill_n(from, std::max<std::ptrdiff_t>((x1 - x0) * units, 0), 0.0F);
    };
    for (int y = wide.y0; y < wide.y1; ++y)
        if (y < inside.y0 || y >= inside.y1) {
            clear(y, wide.x0, wide.x1);
        } else {
            clear(y, wide.x0, inside.x0);
            clear(y, inside.x1, wide.x1);
        }
}

/// Tiles of about the same size, at most `side` long: they depend on the map's size alone. Columns
/// begin at multiples of four pixels where `side` is one, which mostly begin a cache line.
///
///     240 columns, side 48: 5 tiles of 48      100 columns: 32, 32, 36
///     180 rows: 4 of 45                        49 rows: 24, 25
inline std::vector<Tile> tiles_of(int height, int width, int side) {
    const int rows = (height + side - 1) / side, columns = (width + side - 1) / side;
    // So many pixels are shared out together; `side` is a multiple of it, so no tile is longer.
    const int step = side % 4 == 0 ? 4 : 1, steps = (width + step - 1) / step;
    const auto column = [&](int c) { return std::min(steps * c / columns * step, width); };
    std::vector<Tile> tiles;
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c)
            tiles.push_back({height * r / rows, column(c), height * (r + 1) / rows, column(c + 1)});
    return tiles;
}

/// Cuts each row of each tile into groups of `size` pixels, the last of which may have fewer:
/// groups that have a 1 become all 1.
///
///     size 4, a tile of 7     0 0 1 0 | 0 0 0     becomes     1 1 1 1 | 0 0 0
inline void fill_groups(Mask& mask, const std::vector<Tile>& tiles, int size) {
    if (size == 1) return;
    for (const Tile& tile : tiles)
        for (int y = tile.y0; y < tile.y1; ++y)
            for (int x = tile.x0; x < tile.x1; x += size) {
                const auto n = std::size_t(std::min(size, tile.x1 - x));
                std::uint8_t* group = &mask(y, x);
                if (std::memchr(group, 1, n) != nullptr) std::memset(group, 1, n);
            }
}

/// How many numbers lie between row y of a tile and the row to prefetch meanwhile, with rows
/// `pitch` apart; 0 where that is past the tile's last. Maps are larger than a core's cache, and
/// pieces of rows too short for its own foresight.
inline std::ptrdiff_t to_row_ahead(const Tile& tile, int y, std::ptrdiff_t pitch) {
    constexpr int kRows = 2;
    return y + kRows < tile.y1 ? kRows * pitch : 0;
}

/// How a latent map is cut wherever its changes are kept track of (LatentMap::history).
constexpr int kLatentSide = 32;
inline std::vector<Tile> latent_tiles(int height, int width) {
    return tiles_of(height, width, kLatentSide);
}

/// How many outputs a region has.
struct Extent {
    int height = 0, width = 0;
    friend bool operator==(const Extent&, const Extent&) = default;
};

/// Sizes of the tiles, each grown by n within its map.
inline std::vector<Extent> extents_of(const std::vector<Tile>& tiles, int n, int map_height,
                                      int map_width) {
    std::vector<Extent> extents;
    for (const Tile& tile : tiles) {
        const Tile grown = tile.grown(n, map_height, map_width);
        extents.push_back({grown.height(), grown.width()});
    }
    return extents;
}

/// How many threads one step can use: each worker has its own scratch memory.
constexpr int kWorkers = 16;

/// Who computes which of n tiles. Each worker begins with a stretch of its own, where the stretches
/// of another count of the same map lie, too, and then helps the others: so what a core computed
/// last is mostly what it reads next, and is in its cache.
///
///     n = 20     worker 0: 0     1: 1 2     2: 3     3: 4     4: 5     5: 6 7     ...
///
/// On two threads oneTBB begins with workers 0 and 8, which share the tiles half and half.
class TileShares {
public:
    explicit TileShares(int n) : n_(n) {}

    int workers() const { return std::min(n_, kWorkers); }

    /// Calls body(i) for each tile that this worker takes. Any thread.
    template <typename Body>
    void work(int worker, const Body& body) {
        const int w = workers();
        for (int k = 0; k < w; ++k) {
            const int share = (worker + k) % w, begin = n_ * share / w,
                      count = n_ * (share + 1) / w - begin;
            std::atomic<int>& taken = taken_[std::size_t(share)].it;
            // Looked at first, as a look costs next to nothing: most are done.
            while (taken.load(std::memory_order_relaxed) < count)
                if (const int i = taken++; i < count) body(begin + i);
        }
    }

private:
    struct alignas(64) Taken {  // a cache line each
        std::atomic<int> it{0};
    };
    int n_;
    std::array<Taken, kWorkers> taken_;
};

/// Calls body(worker, i) once for each 0 <= i < n. At any time a worker runs on one thread only;
/// which i falls to which worker is left to chance, so results must not depend on the worker.
template <typename Body>
void for_each_tile(const ParallelFor& parallel_for, int n, const Body& body) {
    struct Shared {
        TileShares shares;
        const Body& body;
    } shared{TileShares{n}, body};
    if (n == 0) return;
    // One reference is small enough for std::function to hold without allocating.
    parallel_for(shared.shares.workers(), [&shared](int worker) {
        shared.shares.work(worker, [&](int i) { shared.body(worker, i); });
    });
}

}  // namespace eventide
