// See gated_decoder.h; docs/model.md has the formulas.
#include "src/model/encode/gated_decoder.h"

#include "src/kernels/vector_kernels.h"
#include "src/nn/load_weights.h"
#include "src/nn/upsample2x.h"

#include <algorithm>
#include <cstring>

namespace eventide {

GatedDecoder::GatedDecoder(const Model& model, const std::vector<GatedLevel>& levels,
                           const Backend& backend)
    : top_(std::size_t(model.config.latent_stride - 1)),
      has_out_(model.config.out_layer),
      widths_(model.config.widths),
      numbers_(backend),
      latent_size_(levels[top_].size()) {
    const auto conv = [&](const std::string& name, bool relu, const std::vector<Tile>& tiles,
                          Extent size, const std::vector<int>& sources = {},
                          Summation summation = Summation::best) {
        return PackedConv{
            plain::conv_weights<float>(model.weights, name), 1,       relu,     backend,
            extents_of(tiles, 0, size.height, size.width),   sources, summation};
    };
    // A worker's scratch: what is joined for a layer, then what the layer needs itself.
    const auto need = [&](std::size_t joined, const PackedConv& made, int side) {
        scratch_ = std::max(scratch_, joined + made.scratch_size(side, side));
    };
    for (std::size_t l = 0; l < levels.size(); ++l) {
        const auto [height, width] = levels[l].size();
        Level& level = levels_.emplace_back();
        level.touched = level.room = {height, width};
        if (l < top_ || l + 1 == levels.size()) continue;
        level.up = conv(encoder_layer("up", l), true, levels[l].tiles(), levels[l].size(),
                        {widths_[l + 1], widths_[l]});
        level.d = {height, width, numbers_.units(widths_[l])};
        const int side = levels[l].side(), doubled = numbers_.units(widths_[l + 1]);
        // up2(d_{l+1}) of a tile with a rim of 1.
        need(std::size_t((side + 2) * (side + 2) * doubled), level.up, side);
    }
    const GatedLevel& deepest = levels.back();
    const auto [height, width] = deepest.size();
    const PaddedMap map{height, width, numbers_.units(widths_.back())};
    const PaddedMap sum{height, width, widths_.back()};
    // By groups of four a change would reach four pixels of the deepest level further in each
    // layer, 64 of the sensor's; and so small a map gains no time by them.
    for (std::size_t i = 0; i < std::size_t(model.config.res_blocks); ++i) {
        const std::string name = encoder_layer("res", i);
        const Block& block = blocks_.emplace_back(Block{
            conv(name + ".0", true, deepest.tiles(), deepest.size(), {}, Summation::by_pixel),
            conv(name + ".1", false, deepest.tiles(), deepest.size(), {}, Summation::by_pixel), map,
            map, sum});
        // A row of h in float32, for add(); the second layer is as large as the first.
        need(std::size_t(deepest.side() * widths_.back()), block.first, deepest.side());
    }
    if (!has_out_) return;
    out_ = conv("encoder.out", false, latent_tiles(latent_size_.height, latent_size_.width),
                latent_size_);
    need(0, out_, kLatentSide);
}

void GatedDecoder::run(const std::vector<GatedLevel>& levels, const std::vector<StateMap>& states,
                       bool everywhere, TileRunner& runner) noexcept {
    run_blocks(levels.back(), states.back().read(), everywhere, runner);
    for (std::size_t l = levels.size() - 1; l-- > top_;)
        join(levels[l], states[l].read(), decoded(l + 1, states), l, runner);
    if (has_out_) spread(levels_[top_]);
}

void GatedDecoder::write_codes(const std::vector<StateMap>& states, const Tile& tile,
                               Array3<float>& codes, float* scratch) const noexcept {
    const PaddedMap& from = decoded(top_, states);
    if (!has_out_) {
        const std::size_t bytes = std::size_t(tile.width() * from.channels()) * sizeof(float);
        for (int y = tile.y0; y < tile.y1; ++y)
            std::memcpy(codes.pixel(y, tile.x0).data(), from.at(y, tile.x0), bytes);
        return;
    }
    out_.run(ConvArea{{{{from.at(tile.y0 - 1, tile.x0 - 1), from.pitch()}}},
                      codes.pixel(tile.y0, tile.x0).data(),
                      std::ptrdiff_t(codes.width()) * codes.channels(),
                      true,
                      tile.height(),
                      tile.width()},
             scratch);
}

/// A tile of `to`, from the tile of `from` and a rim of 1, which may be its border of zeros.
void GatedDecoder::convolve(const PackedConv& conv, const PaddedMap& from, PaddedMap& to,
                            bool to_bf16, const Tile& tile, float* scratch) noexcept {
    conv.run(ConvArea{{{{from.at(tile.y0 - 1, tile.x0 - 1), from.pitch()}}},
                      to.at(tile.y0, tile.x0),
                      to.pitch(),
                      to_bf16,
                      tile.height(),
                      tile.width()},
             scratch);
}

void GatedDecoder::spread(Level& level) noexcept {
    dilate(level.touched, 1, level.room);
}

/// d_l, as layers read it.
const PaddedMap& GatedDecoder::decoded(std::size_t l, const std::vector<StateMap>& states) const {
    if (l + 1 < levels_.size()) return levels_[l].d;
    return blocks_.empty() ? states[l].read() : blocks_.back().out;
}

/// d <- relu(d + second(relu(first(d)))), from the deepest state on.
void GatedDecoder::run_blocks(const GatedLevel& deepest, const PaddedMap& h, bool everywhere,
                              TileRunner& runner) noexcept {
    Level& level = levels_.back();
    if (everywhere)
        std::ranges::fill(level.touched.values(), std::uint8_t{1});
    else
        std::ranges::copy(deepest.mask().values(), level.touched.values().begin());
    const PaddedMap *d = &h, *before = &h;
    // `d` is the map that layers read, `before` the one that a block adds: with bf16 products the
    // state itself is bf16, the sums of the blocks behind it are float32.
    bool is_float = numbers_.bf16() == nullptr;
    for (Block& block : blocks_) {
        spread(level);
        runner.over(deepest.tiles(), level.touched,
                    [&](std::size_t, const Tile& tile, float* scratch) {
                        convolve(block.first, *d, block.inner, true, tile, scratch);
                    });
        spread(level);
        runner.over(deepest.tiles(), level.touched,
                    [&](std::size_t, const Tile& tile, float* scratch) {
                        convolve(block.second, block.inner, block.sum, false, tile, scratch);
                        add(*before, is_float, block, tile, scratch);
                    });
        d = &block.out;
        before = &block.sum;
        is_float = true;
    }
}

/// Closes a block: sum <- relu(before + sum), and what layers read of it.
void GatedDecoder::add(const PaddedMap& before, bool is_float, Block& block, const Tile& tile,
                       float* scratch) const noexcept {
    const auto width = std::size_t(tile.width());
    const int channels = widths_.back();
    for (int y = tile.y0; y < tile.y1; ++y) {
        const float* skip = before.at(y, tile.x0);
        if (!is_float) {
            numbers_.to_float(skip, width, channels, scratch);
            skip = scratch;
        }
        float* sum = block.sum.at(y, tile.x0);
        numbers_.kernels().add_relu(skip, sum, sum, width * std::size_t(channels));
        numbers_.from_float(sum, width, channels, block.out.at(y, tile.x0));
    }
}

void GatedDecoder::join(const GatedLevel& level, const PaddedMap& h, const PaddedMap& below,
                        std::size_t l, TileRunner& runner) noexcept {
    Level& joined = levels_[l];
    join_doubled(level.mask(), levels_[l + 1].touched, joined.touched);
    spread(joined);
    runner.over(level.tiles(), joined.touched, [&](std::size_t, const Tile& tile, float* scratch) {
        join_tile(h, below, l, tile, scratch);
    });
    fill_groups(joined.touched, level.tiles(), joined.up.group());
}

/// d_l = relu(up.l * [up2(d_{l+1}); h_l])
/// up2 goes into scratch, h is read where it lies:
///
///     scratch    (height + 2) x (width + 2) pixels of d_{l+1}'s units, zeros past the map's edge;
///                behind them what the layer needs
///
/// Each tile writes its own part of d_l; d_{l+1} and h_l are only read meanwhile.
void GatedDecoder::join_tile(const PaddedMap& h, const PaddedMap& below, std::size_t l,
                             const Tile& tile, float* scratch) noexcept {
    Level& level = levels_[l];
    const std::ptrdiff_t units = below.channels(), row = (tile.width() + 2) * units;
    const Tile near = tile.grown(1, h.height(), h.width());
    clear_outside(tile.widened(1), near, scratch, row, units);
    for (int y = near.y0; y < near.y1; ++y)
        double_row(below, numbers_, widths_[l + 1], y, near.x0, near.x1,
                   scratch + (y - tile.y0 + 1) * row + (near.x0 - tile.x0 + 1) * units);
    level.up.run(ConvArea{{{{scratch, row}, {h.at(tile.y0 - 1, tile.x0 - 1), h.pitch()}}},
                          level.d.at(tile.y0, tile.x0),
                          level.d.pitch(),
                          true,
                          tile.height(),
                          tile.width()},
                 scratch + (tile.height() + 2) * row);
}

}  // namespace eventide
