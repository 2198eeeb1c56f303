// See gated_encoder.h; docs/model.md has the formulas.
//
// A network of widths 8, 16, 32, 64, 64 whose top level alone is recurrent, at 240x180; a step goes
// down the table (GatedLevel), then up again (GatedDecoder):
//
//     level    map        channels    keeps            tiles       on the way up
//     0        240x180    8           ConvGRU          20 of 48    d_0 from up2(d_1) and h_0
//     1        120x90     16          held features    20 of 24    d_1
//     2        60x45      32          held features    12 of 16    d_2
//     3        30x23      64          held features    6 of 12     d_3 from up2(d_4) and h_3
//     4        15x12      64          held features    2 of 12     d_4 from h_4, residual blocks
//     codes    240x180    16                           48 of 32    z from d_0
#include "src/model/encode/gated_encoder.h"

#include "src/model/encode/plain_encoder.h"

#include <algorithm>
#include <cstring>

namespace eventide {
namespace {

std::vector<GatedLevel> levels_of(const Model& model, int height, int width,
                                  const Backend& backend) {
    std::vector<GatedLevel> levels;
    for (const auto& [rows, columns] : plain::level_sizes(height, width, model.config.levels()))
        levels.emplace_back(model, levels.size(), Extent{rows, columns}, backend);
    return levels;
}

}  // namespace

GatedEncoder::GatedEncoder(const Model& model, int height, int width, const EngineOptions& options,
                           const Backend& backend)
    : config_(model.config),
      options_(options),
      backend_(backend),
      levels_(levels_of(model, height, width, backend)),
      decoder_(model, levels_, backend),
      latent_(decoder_.latent_size().height, decoder_.latent_size().width),
      runner_(options.parallel_for, options.skip_quiet),
      top_room_(levels_.front().mask()),
      deepest_room_(levels_.back().mask()) {
    std::size_t scratch = decoder_.scratch_size(), tiles = 0;
    for (std::size_t l = 0; l < levels_.size(); ++l) {
        const Extent size = levels_[l].size();
        states_.emplace_back(size.height, size.width, config_.widths[l], Numbers{backend},
                             config_.recurrent[l] != 0);
        scratch = std::max(scratch, levels_[l].scratch_size());
        tiles = std::max(tiles, levels_[l].tiles().size());
    }
    runner_.make_room(scratch, std::max(tiles, latent_.tiles().size()));
}

std::string GatedEncoder::description() const {
    return engine_name(backend_);
}

void GatedEncoder::step(const VoxelGrid& grid, LatentCodes& latent) noexcept {
    latent_.begin_step();
    // Where nothing happens, no state changes, and nothing that follows from them does.
    if (mark_events(grid) || stale_ || !options_.skip_quiet) {
        for (GatedLevel& level : levels_) advance(level, grid.values);
        decoder_.run(levels_, states_, stale_, runner_);
        for (std::size_t i = 0; i < latent_.tiles().size(); ++i)
            if (decoder_.changes(latent_.tiles()[i]) || !options_.skip_quiet)
                latent_.mark_changed(i);
        stale_ = false;
    }
    // Also where nothing happened: this buffer may hold codes of a step long before.
    runner_.over(latent_.tiles(), [&](std::size_t i, const Tile& tile, float* scratch) {
        if (latent_.is_outdated(i, latent))
            decoder_.write_codes(states_, tile, latent.values, scratch);
    });
    latent.history = latent_.history();
}

/// m_0 = events, dilated by gate_radius; m_{l+1} = halved m_l; the deepest dilated by gate_spread.
bool GatedEncoder::mark_events(const VoxelGrid& grid) noexcept {
    Mask& top = levels_.front().mask();
    if (!grid.touched.empty())
        std::ranges::copy(grid.touched.values(), top.values().begin());
    else
        for (int y = 0; y < top.height(); ++y) {
            const float* pixel = grid.values.pixel(y, 0).data();
            for (int x = 0; x < top.width(); ++x, pixel += grid.values.channels()) {
                bool any = false;
                // Channel 4 b + 3 of a grid counts the events of bin b.
                for (int b = 0; b < config_.bins; ++b) any |= pixel[4 * b + 3] != 0;
                top(y, x) = std::uint8_t(any);
            }
        }
    const bool any = std::memchr(top.values().data(), 1, top.values().size()) != nullptr;
    if (any) dilate(top, config_.gate_radius, top_room_);
    for (std::size_t l = 1; l < levels_.size(); ++l)
        halve(levels_[l - 1].mask(), levels_[l].mask());
    Mask& deepest = levels_.back().mask();
    if (any) dilate(deepest, config_.gate_spread, deepest_room_);
    return any;
}

void GatedEncoder::advance(GatedLevel& level, const Array3<float>& grid) noexcept {
    const auto advance = [&](std::size_t i, const Tile&, float* scratch) {
        level.advance(grid, states_, i, scratch);
    };
    if (level.is_recurrent())
        runner_.in_groups(level.tiles(), level.mask(), level.group(), advance,
                          [&](std::size_t i, const Tile&, float*) { level.commit(states_, i); });
    else
        runner_.over(level.tiles(), level.mask(), advance);
}

void GatedEncoder::reset() noexcept {
    for (StateMap& h : states_) h.clear();
    stale_ = true;
}

void GatedEncoder::restore(const Tensors& state) {
    load(state, states_);
    stale_ = true;
}

}  // namespace eventide
