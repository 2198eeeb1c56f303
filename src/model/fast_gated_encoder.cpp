// See fast_gated_encoder.h; docs/model.md has the formulas.
#include "src/model/fast_gated_encoder.h"

#include "src/kernels/vector_kernels.h"
#include "src/model/plain_encoder.h"

#include <algorithm>
#include <cstring>
#include <string>

namespace eventide {
namespace {

/// Small enough that a tile's maps stay in a core's own cache, large enough that borders computed
/// twice cost little. Deeper levels have more channels and smaller maps.
constexpr int kSides[] = {32, 24, 16, 12};

int side_of(int level) {
    return kSides[std::min(level, 3)];
}

std::string named(const char* part, std::size_t i) {
    return "encoder." + std::string{part} + "." + std::to_string(i);
}

}  // namespace

FastGatedEncoder::FastGatedEncoder(const Model& model, int height, int width,
                                   const EngineOptions& options, const Arithmetic& arithmetic)
    : FastEncoder(options, arithmetic), config_(model.config) {
    const auto sizes = plain::level_sizes(height, width, config_.levels());
    const auto last = std::size_t(config_.latent_stride - 1);
    std::size_t scratch = 0;
    for (std::size_t l = 0; l < sizes.size(); ++l)
        scratch = std::max(scratch, make_level(model, l, {sizes[l].first, sizes[l].second}));
    const auto conv = [&](const std::string& name, bool relu, std::vector<Extent> extents) {
        return PackedConv{plain::conv_weights<float>(model.weights, name), 1, relu, arithmetic_,
                          std::move(extents)};
    };
    const auto room_for = [&](const PackedConv& made, int side) {
        scratch = std::max(scratch, made.scratch_size(side, side));
    };
    const auto [rows, columns] = sizes.back();
    const Level& deepest = levels_.back();
    for (std::size_t i = 0; i < std::size_t(config_.res_blocks); ++i) {
        const auto extents = extents_of(deepest.tiles, 0, rows, columns);
        const Block& block =
            blocks_.emplace_back(Block{conv(named("res", i) + ".0", true, extents),
                                       conv(named("res", i) + ".1", false, extents),
                                       {rows, columns, config_.widths.back()},
                                       {rows, columns, config_.widths.back()}});
        room_for(block.first, deepest.side);
        room_for(block.second, deepest.side);
    }
    const auto [latent_height, latent_width] = sizes[last];
    const auto tiles = latent_tiles(latent_height, latent_width);
    out_ = conv("encoder.out", false, extents_of(tiles, 0, latent_height, latent_width));
    room_for(out_, kLatentSide);
    out_touched_ = levels_[last].mask;
    make_room(latent_height, latent_width, config_.latent, scratch);
    std::size_t most_tiles = latent_tiles_.size();
    for (const Level& level : levels_) most_tiles = std::max(most_tiles, level.tiles.size());
    active_.reserve(most_tiles);
}

/// Returns the scratch numbers it needs.
std::size_t FastGatedEncoder::make_level(const Model& model, std::size_t l, Extent size) {
    const auto [rows, columns] = size;
    const int channels = config_.widths[l];
    const bool deepest = l + 1 == config_.widths.size();
    const auto weights = [&](const std::string& name) {
        return plain::conv_weights<float>(model.weights, name);
    };
    Level& level = levels_.emplace_back();
    level.number = l;
    level.side = side_of(int(l));
    level.tiles = tiles_of(rows, columns, level.side);
    level.recurrent = config_.recurrent[l] != 0;
    level.mask = level.touched = {rows, columns};
    mask_scratch_.push_back(level.mask);
    states_.emplace_back(rows, columns, channels);
    // What a GRU's step reads of its input reaches 2 further than its tile.
    auto fed = extents_of(level.tiles, level.recurrent ? 2 : 0, rows, columns);
    level.in = {weights(l == 0 ? "encoder.in" : named("down", l)), l == 0 ? 1 : 2, true,
                arithmetic_, std::move(fed)};
    if (level.recurrent)
        level.gru = {plain::gru_weights<float>(model.weights, named("gru", l)), size, level.tiles,
                     level.side, arithmetic_};
    else
        for (const Tile& tile : level.tiles)
            level.held.emplace_back(std::size_t(tile.height()) * std::size_t(tile.width()) *
                                    std::size_t(channels));
    const auto area = [](int n) { return std::size_t(n) * std::size_t(n); };
    const int fed_side = level.side + (level.recurrent ? 4 : 0);
    const std::size_t grid =
        l == 0 ? area(fed_side + 2) * std::size_t(config_.input_channels()) : 0;
    std::size_t scratch =
        level.gru.scratch_size() + grid + level.in.scratch_size(fed_side, fed_side);
    if (l >= std::size_t(config_.latent_stride - 1) && !deepest) {
        level.up = {weights(named("up", l)), 1, true, arithmetic_,
                    extents_of(level.tiles, 0, rows, columns)};
        level.decoded = {rows, columns, channels};
        const auto joined = std::size_t(channels + config_.widths[l + 1]);
        scratch = std::max(
            scratch, area(level.side + 2) * joined + level.up.scratch_size(level.side, level.side));
    }
    return scratch;
}

void FastGatedEncoder::step(const VoxelGrid& grid, LatentMap& latent) noexcept {
    ++history_.step;
    // Where nothing happens, no state changes, and nothing that follows from them does.
    if (mark_events(grid) || stale_ || !options_.skip_quiet) {
        for (std::size_t l = 0; l < levels_.size(); ++l) advance(l, grid.values);
        read_out();
    }
    hand_out(latent);
}

bool FastGatedEncoder::mark_events(const VoxelGrid& grid) noexcept {
    Mask& top = levels_[0].mask;
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
    if (any) dilate(top, config_.gate_radius, mask_scratch_[0], top);
    for (std::size_t l = 1; l < levels_.size(); ++l) halve(levels_[l - 1].mask, levels_[l].mask);
    Mask& deepest = levels_.back().mask;
    if (any) dilate(deepest, config_.gate_spread, mask_scratch_.back(), deepest);
    return any;
}

int FastGatedEncoder::collect(const std::vector<Tile>& tiles, const Mask& mask) noexcept {
    active_.clear();
    for (std::size_t i = 0; i < tiles.size(); ++i)
        if (!options_.skip_quiet || tiles[i].any(mask)) active_.push_back(int(i));
    return int(active_.size());
}

void FastGatedEncoder::advance(std::size_t l, const Array3<float>& grid) noexcept {
    Level& level = levels_[l];
    const int count = collect(level.tiles, level.mask);
    PaddedMap& h = states_[l];
    for_each_tile(options_.parallel_for, count, [&](int lane, int n) {
        advance_tile(level, l, std::size_t(active_[std::size_t(n)]), grid,
                     scratch_[std::size_t(lane)].data());
    });
    for_each_tile(options_.parallel_for, count, [&](int, int n) {
        const auto i = std::size_t(active_[std::size_t(n)]);
        if (level.recurrent) {
            level.gru.commit(h, i);
            return;
        }
        const Tile& tile = level.tiles[i];
        const auto c = std::size_t(h.channels());
        const float* next = level.held[i].data();
        for (int y = tile.y0; y < tile.y1; ++y)
            for (int x = tile.x0; x < tile.x1; ++x, next += c)
                if (level.mask(y, x) != 0) std::memcpy(h.at(y, x), next, c * sizeof(float));
    });
}

void FastGatedEncoder::advance_tile(Level& level, std::size_t l, std::size_t i,
                                    const Array3<float>& grid, float* scratch) noexcept {
    if (level.recurrent) {
        float* source = scratch + level.gru.scratch_size();
        level.gru.step(states_[l], i, &level.mask, scratch, [&](const GruTiles::Target& target) {
            feed(level, l, target.region, grid, target.out, target.pitch, target.step, source);
        });
        return;
    }
    const Tile& tile = level.tiles[i];
    const std::ptrdiff_t c = states_[l].channels();
    feed(level, l, tile, grid, level.held[i].data(), tile.width() * c, c, scratch);
}

/// a_l in a region.
void FastGatedEncoder::feed(const Level& level, std::size_t l, const Tile& region,
                            const Array3<float>& grid, float* out, std::ptrdiff_t pitch,
                            std::ptrdiff_t step, float* scratch) noexcept {
    if (l > 0) {
        const PaddedMap& above = states_[l - 1];
        level.in.run({above.at(2 * region.y0 - 1, 2 * region.x0 - 1), above.pitch(), out, pitch,
                      step, region.height(), region.width()},
                     scratch);
        return;
    }
    // The compressed grid around the region, zeros outside the sensor.
    const Tile wide{region.y0 - 1, region.x0 - 1, region.y1 + 1, region.x1 + 1};
    const Tile inside = region.grown(1, grid.height(), grid.width());
    const std::ptrdiff_t channels = grid.channels(), row = wide.width() * channels;
    if (inside.height() < wide.height() || inside.width() < wide.width())
        std::memset(scratch, 0, std::size_t(wide.height() * row) * sizeof(float));
    for (int y = inside.y0; y < inside.y1; ++y)
        vector_kernels().compress(grid.pixel(y, inside.x0).data(),
                                  scratch + (y - wide.y0) * row + (inside.x0 - wide.x0) * channels,
                                  std::size_t(inside.width()) * std::size_t(channels));
    level.in.run({scratch, row, out, pitch, step, region.height(), region.width()},
                 scratch + wide.height() * row);
}

template <typename Body>
void FastGatedEncoder::over_touched(const std::vector<Tile>& tiles, Mask& touched, Mask& room,
                                    const Body& body) noexcept {
    if (!stale_) dilate(touched, 1, room, touched);
    const int count = collect(tiles, touched);
    for_each_tile(options_.parallel_for, count, [&](int lane, int n) {
        const auto i = std::size_t(active_[std::size_t(n)]);
        body(i, tiles[i], scratch_[std::size_t(lane)].data());
    });
}

const PaddedMap& FastGatedEncoder::decoded(std::size_t l) const {
    if (l + 1 < levels_.size()) return levels_[l].decoded;
    return blocks_.empty() ? states_[l] : blocks_.back().out;
}

void FastGatedEncoder::read_out() noexcept {
    const std::size_t last = std::size_t(config_.latent_stride - 1);
    Level& deepest = levels_.back();
    std::ranges::copy(deepest.mask.values(), deepest.touched.values().begin());
    if (stale_) std::ranges::fill(deepest.touched.values(), std::uint8_t{1});

    const auto conv = [](const PackedConv& weights, const PaddedMap& from, PaddedMap& to,
                         const Tile& tile, float* scratch) {
        weights.run({from.at(tile.y0 - 1, tile.x0 - 1), from.pitch(), to.at(tile.y0, tile.x0),
                     to.pitch(), to.channels(), tile.height(), tile.width()},
                    scratch);
    };
    const PaddedMap* d = &states_.back();
    for (Block& block : blocks_) {
        over_touched(deepest, [&](std::size_t, const Tile& tile, float* scratch) {
            conv(block.first, *d, block.inner, tile, scratch);
        });
        over_touched(deepest, [&](std::size_t, const Tile& tile, float* scratch) {
            conv(block.second, block.inner, block.out, tile, scratch);
            const auto row = std::size_t(tile.width()) * std::size_t(d->channels());
            for (int y = tile.y0; y < tile.y1; ++y)
                vector_kernels().add_relu(d->at(y, tile.x0), block.out.at(y, tile.x0),
                                          block.out.at(y, tile.x0), row);
        });
        d = &block.out;
    }
    for (std::size_t l = levels_.size() - 1; l-- > last;) {
        Level& level = levels_[l];
        const Mask& below = levels_[l + 1].touched;
        join_doubled(level.mask, below, level.touched);
        const PaddedMap& from = decoded(l + 1);
        over_touched(level, [&](std::size_t, const Tile& tile, float* scratch) {
            decode_tile(level, from, tile, scratch);
        });
    }
    std::ranges::copy(levels_[last].touched.values(), out_touched_.values().begin());
    over_touched(latent_tiles_, out_touched_, mask_scratch_[last],
                 [&](std::size_t i, const Tile& tile, float* scratch) {
                     conv(out_, decoded(last), latent_, tile, scratch);
                     mark_changed(i);
                 });
    stale_ = false;
}

/// d_l = relu(up.l * [up2(d_{l+1}); h_l])
void FastGatedEncoder::decode_tile(Level& level, const PaddedMap& below, const Tile& tile,
                                   float* scratch) noexcept {
    const PaddedMap& h = states_[level.number];
    const std::ptrdiff_t mine = h.channels(), deeper = below.channels(), step = mine + deeper;
    const std::ptrdiff_t row = (tile.width() + 2) * step;
    const Tile near = tile.grown(1, h.height(), h.width());
    if (near.height() < tile.height() + 2 || near.width() < tile.width() + 2)
        std::memset(scratch, 0, std::size_t((tile.height() + 2) * row) * sizeof(float));
    for (int y = near.y0; y < near.y1; ++y) {
        const int y0 = y / 2, y1 = std::min((y + 1) / 2, below.height() - 1);
        float* to = scratch + (y - tile.y0 + 1) * row + (near.x0 - tile.x0 + 1) * step;
        for (int x = near.x0; x < near.x1; ++x, to += step) {
            const int x0 = x / 2, x1 = std::min((x + 1) / 2, below.width() - 1);
            vector_kernels().average(below.at(y0, x0), below.at(y0, x1), below.at(y1, x0),
                                     below.at(y1, x1), to, int(deeper));
            std::memcpy(to + deeper, h.at(y, x), std::size_t(mine) * sizeof(float));
        }
    }
    level.up.run({scratch, row, level.decoded.at(tile.y0, tile.x0), level.decoded.pitch(), mine,
                  tile.height(), tile.width()},
                 scratch + (tile.height() + 2) * row);
}

void FastGatedEncoder::reset() noexcept {
    for (PaddedMap& h : states_) h.clear();
    stale_ = true;
}

}  // namespace eventide
