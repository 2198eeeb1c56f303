// Work on tiles: which of them, on whose threads, with which scratch memory.
#pragma once

#include "src/nn/conv_gru.h"
#include "src/nn/tiling.h"

#include <utility>
#include <vector>

namespace eventide {

class TileRunner {
public:
    /// `skip_quiet`: whether masks are heeded at all.
    TileRunner(ParallelFor parallel_for, bool skip_quiet)
        : parallel_for_(std::move(parallel_for)), skip_quiet_(skip_quiet) {}

    /// `scratch` numbers for each lane, and no more than `tiles` tiles at a time. Nothing allocates
    /// after it.
    void make_room(std::size_t scratch, std::size_t tiles) {
        scratch_.assign(kLanes, FloatBuffer(scratch));
        active_.reserve(tiles);
    }

    /// body(i, tile, scratch) for each tile.
    template <typename Body>
    void over(const std::vector<Tile>& tiles, const Body& body) noexcept {
        for_each_tile(parallel_for_, int(tiles.size()), [&](int lane, int n) {
            const auto i = std::size_t(n);
            body(i, tiles[i], scratch_[std::size_t(lane)].data());
        });
    }

    /// The same for the tiles in which `where` has anything.
    template <typename Body>
    void over(const std::vector<Tile>& tiles, const Mask& where, const Body& body) noexcept {
        active_.clear();
        for (std::size_t i = 0; i < tiles.size(); ++i)
            if (!skip_quiet_ || tiles[i].any(where)) active_.push_back(int(i));
        for_each_tile(parallel_for_, int(active_.size()), [&](int lane, int n) {
            const auto i = std::size_t(active_[std::size_t(n)]);
            body(i, tiles[i], scratch_[std::size_t(lane)].data());
        });
    }

private:
    ParallelFor parallel_for_;
    bool skip_quiet_;
    std::vector<FloatBuffer> scratch_;  // per lane
    std::vector<int> active_;           // numbers of the tiles at work
};

}  // namespace eventide
