// See fast_gated_encoder.h; docs/model.md has the formulas.
#include "src/model/encode/fast_gated_encoder.h"

#include "src/model/encode/plain_encoder.h"

#include <algorithm>
#include <cstring>

namespace eventide {
namespace {

std::vector<GatedLevel> levels_of(const Model& model, int height, int width,
                                  const Arithmetic& arithmetic) {
    std::vector<GatedLevel> levels;
    for (const auto& [rows, columns] : plain::level_sizes(height, width, model.config.levels()))
        levels.emplace_back(model, levels.size(), Extent{rows, columns}, arithmetic);
    return levels;
}

}  // namespace

FastGatedEncoder::FastGatedEncoder(const Model& model, int height, int width,
                                   const EngineOptions& options, const Arithmetic& arithmetic)
    : FastEncoder(options, arithmetic),
      config_(model.config),
      levels_(levels_of(model, height, width, arithmetic)),
      decoder_(model, levels_, arithmetic),
      top_room_(levels_.front().mask()),
      deepest_room_(levels_.back().mask()) {
    std::size_t scratch = decoder_.scratch_size(), tiles = 0;
    for (std::size_t l = 0; l < levels_.size(); ++l) {
        const Extent size = levels_[l].size();
        states_.emplace_back(size.height, size.width, config_.widths[l],
                             Numbers{arithmetic.products}, config_.recurrent[l] != 0);
        scratch = std::max(scratch, levels_[l].scratch_size());
        tiles = std::max(tiles, levels_[l].tiles().size());
    }
    const auto [rows, columns] = decoder_.latent_size();
    make_room(rows, columns, scratch, tiles);
}

void FastGatedEncoder::step(const VoxelGrid& grid, LatentMap& latent) noexcept {
    ++history_.step;
    // Where nothing happens, no state changes, and nothing that follows from them does.
    if (mark_events(grid) || stale_ || !options_.skip_quiet) {
        for (GatedLevel& level : levels_) advance(level, grid.values);
        decoder_.run(levels_, states_, stale_, runner_);
        for (std::size_t i = 0; i < latent_tiles_.size(); ++i)
            if (decoder_.changes(latent_tiles_[i]) || !options_.skip_quiet) mark_changed(i);
        stale_ = false;
    }
    runner_.over(latent_tiles_, [&](std::size_t i, const Tile& tile, float* scratch) {
        if (is_outdated(i, latent)) decoder_.write_codes(states_, tile, latent.values, scratch);
    });
    latent.history = history_;
}

bool FastGatedEncoder::mark_events(const VoxelGrid& grid) noexcept {
    Mask& top = levels_.front().mask();
    if (!grid.touched.empty())
        std::ranges::copy(grid.touched.values(), top.values().begin());
    else
        for (int y = 0; y < top.height(); ++y) {
            const float* pixel = grid.values.pixel(y, 0).data();
            for (int x = 0; x < top.width(); ++x, pixel += grid.values.channels()) {
                bool any = false;
                for (int b = 0; b < config_.bins; ++b) any |= pixel[4 * b + 3] != 0;
                top(y, x) = std::uint8_t(any);
            }
        }
    const bool any = std::memchr(top.values().data(), 1, top.values().size()) != nullptr;
    if (any) dilate(top, config_.gate_radius, top_room_, top);
    for (std::size_t l = 1; l < levels_.size(); ++l)
        halve(levels_[l - 1].mask(), levels_[l].mask());
    Mask& deepest = levels_.back().mask();
    if (any) dilate(deepest, config_.gate_spread, deepest_room_, deepest);
    return any;
}

void FastGatedEncoder::advance(GatedLevel& level, const Array3<float>& grid) noexcept {
    const auto advance = [&](std::size_t i, const Tile&, float* scratch) {
        level.advance(grid, states_, i, scratch);
    };
    if (level.is_recurrent())
        runner_.in_groups(level.tiles(), level.mask(), level.group(), advance,
                          [&](std::size_t i, const Tile&, float*) { level.commit(states_, i); });
    else
        runner_.over(level.tiles(), level.mask(), advance);
}

void FastGatedEncoder::reset() noexcept {
    for (StateMap& h : states_) h.clear();
    stale_ = true;
}

}  // namespace eventide
