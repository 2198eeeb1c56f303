// Work on tiles: which of them, on whose threads, with which scratch memory.
#pragma once

#include "src/nn/conv_gru.h"
#include "src/nn/tiling.h"
#include "src/nn/untouched_zeros.h"

#include <utility>
#include <vector>

namespace eventide {

class TileRunner {
public:
    /// `skip_quiet`: whether masks are heeded at all.
    TileRunner(ParallelFor parallel_for, bool skip_quiet)
        : parallel_for_(std::move(parallel_for)), skip_quiet_(skip_quiet) {}

    /// `scratch` numbers for each worker, and no more than `tiles` tiles at a time. Nothing
    /// allocates after it.
    void make_room(std::size_t scratch, std::size_t tiles) {
        scratch_.clear();
        for (int worker = 0; worker < kWorkers; ++worker) scratch_.emplace_back(scratch);
        active_.reserve(tiles);
    }

    /// body(i, tile, scratch) for each tile.
    template <typename Body>
    void over(const std::vector<Tile>& tiles, const Body& body) noexcept {
        for_each_tile(parallel_for_, int(tiles.size()), [&](int worker, int n) {
            const auto i = std::size_t(n);
            body(i, tiles[i], scratch_[std::size_t(worker)].data());
        });
    }

    /// The same for the tiles in which `where` has anything.
    template <typename Body>
    void over(const std::vector<Tile>& tiles, const Mask& where, const Body& body) noexcept {
        choose(tiles, where);
        run(tiles, {0, active_.size()}, body);
    }

    /// For work in two halves, on groups of `group` consecutive tiles: first() for a group's tiles,
    /// then second() for those of the group before. At most two groups are between their halves.
    ///
    ///     first     0    1         2         3               group numbers, in order of time
    ///     second              0         1         2    3
    ///     between   0    0 1       1 2       2 3             what ConvGru holds aside
    template <typename First, typename Second>
    void in_groups(const std::vector<Tile>& tiles, const Mask& where, std::size_t group,
                   const First& first, const Second& second) noexcept {
        choose(tiles, where);
        Range before;
        for (std::size_t at = 0; at < active_.size();) {
            const std::size_t number = group_of(at, group);
            Range now{at, at + 1};
            while (now.end < active_.size() && group_of(now.end, group) == number) ++now.end;
            // None of the group between has work, and this one takes the place of the one before.
            const bool is_next =
                before.end > before.begin && number == group_of(before.begin, group) + 1;
            if (!is_next) run(tiles, std::exchange(before, {}), second);
            run(tiles, now, first);
            run(tiles, before, second);
            before = now;
            at = now.end;
        }
        run(tiles, before, second);
    }

private:
    /// Places in active_, `end` excluded.
    struct Range {
        std::size_t begin = 0, end = 0;
    };
    void choose(const std::vector<Tile>& tiles, const Mask& where) noexcept {
        active_.clear();
        for (std::size_t i = 0; i < tiles.size(); ++i)
            if (!skip_quiet_ || tiles[i].any(where)) active_.push_back(int(i));
    }
    std::size_t group_of(std::size_t at, std::size_t group) const {
        return std::size_t(active_[at]) / group;
    }
    template <typename Body>
    void run(const std::vector<Tile>& tiles, const Range& range, const Body& body) noexcept {
        for_each_tile(parallel_for_, int(range.end - range.begin), [&](int worker, int n) {
            const auto i = std::size_t(active_[range.begin + std::size_t(n)]);
            body(i, tiles[i], scratch_[std::size_t(worker)].data());
        });
    }

    ParallelFor parallel_for_;
    bool skip_quiet_;
    // Worker w writes scratch_[w] alone; active_ is written between runs, and read by all workers.
    std::vector<UntouchedZeros> scratch_;  // per worker
    std::vector<int> active_;              // numbers of the tiles at work
};

}  // namespace eventide
