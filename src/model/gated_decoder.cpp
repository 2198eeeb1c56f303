// See gated_decoder.h; docs/model.md has the formulas.
#include "src/model/gated_decoder.h"

#include "src/kernels/vector_kernels.h"
#include "src/nn/load_weights.h"
#include "src/nn/upsample2x.h"

#include <algorithm>
#include <cstring>

namespace eventide {

GatedDecoder::GatedDecoder(const Model& model, const std::vector<GatedLevel>& levels,
                           const Arithmetic& arithmetic)
    : top_(std::size_t(model.config.latent_stride - 1)),
      latent_size_(levels[top_].size()),
      latent_tiles_(latent_tiles(latent_size_.height, latent_size_.width)) {
    const auto conv = [&](const std::string& name, bool relu, const std::vector<Tile>& tiles,
                          Extent size) {
        return PackedConv{plain::conv_weights<float>(model.weights, name), 1, relu, arithmetic,
                          extents_of(tiles, 0, size.height, size.width)};
    };
    const auto need = [&](std::size_t joined, const PackedConv& made, int side) {
        scratch_ = std::max(scratch_, joined + made.scratch_size(side, side));
    };
    const std::vector<int>& widths = model.config.widths;
    for (std::size_t l = 0; l < levels.size(); ++l) {
        const auto [height, width] = levels[l].size();
        Level& level = levels_.emplace_back();
        level.touched = level.room = {height, width};
        if (l < top_ || l + 1 == levels.size()) continue;
        level.up = conv(encoder_layer("up", l), true, levels[l].tiles(), levels[l].size());
        level.d = {height, width, widths[l]};
        const int side = levels[l].side(), joined = widths[l] + widths[l + 1];
        need(std::size_t((side + 2) * (side + 2) * joined), level.up, side);
    }
    const GatedLevel& deepest = levels.back();
    const PaddedMap map{deepest.size().height, deepest.size().width, widths.back()};
    for (std::size_t i = 0; i < std::size_t(model.config.res_blocks); ++i) {
        const std::string name = encoder_layer("res", i);
        const Block& block = blocks_.emplace_back(
            Block{conv(name + ".0", true, deepest.tiles(), deepest.size()),
                  conv(name + ".1", false, deepest.tiles(), deepest.size()), map, map});
        need(0, block.first, deepest.side());
        need(0, block.second, deepest.side());
    }
    out_ = conv("encoder.out", false, latent_tiles_, latent_size_);
    need(0, out_, kLatentSide);
}

void GatedDecoder::convolve(const PackedConv& conv, const PaddedMap& from, PaddedMap& to,
                            const Tile& tile, float* scratch) noexcept {
    conv.run({from.at(tile.y0 - 1, tile.x0 - 1), from.pitch(), to.at(tile.y0, tile.x0), to.pitch(),
              to.channels(), tile.height(), tile.width()},
             scratch);
}

void GatedDecoder::spread(Level& level) noexcept {
    dilate(level.touched, 1, level.room, level.touched);
}

const PaddedMap& GatedDecoder::decoded(std::size_t l, const std::vector<PaddedMap>& states) const {
    if (l + 1 < levels_.size()) return levels_[l].d;
    return blocks_.empty() ? states[l] : blocks_.back().out;
}

/// d <- relu(d + second(relu(first(d)))), from the deepest state on.
void GatedDecoder::run_blocks(const GatedLevel& deepest, const PaddedMap& h, bool everywhere,
                              TileRunner& runner) noexcept {
    Level& level = levels_.back();
    if (everywhere)
        std::ranges::fill(level.touched.values(), std::uint8_t{1});
    else
        std::ranges::copy(deepest.mask().values(), level.touched.values().begin());
    const PaddedMap* d = &h;
    for (Block& block : blocks_) {
        spread(level);
        runner.over(deepest.tiles(), level.touched,
                    [&](std::size_t, const Tile& tile, float* scratch) {
                        convolve(block.first, *d, block.inner, tile, scratch);
                    });
        spread(level);
        runner.over(deepest.tiles(), level.touched,
                    [&](std::size_t, const Tile& tile, float* scratch) {
                        convolve(block.second, block.inner, block.out, tile, scratch);
                        const auto row = std::size_t(tile.width()) * std::size_t(d->channels());
                        for (int y = tile.y0; y < tile.y1; ++y)
                            vector_kernels().add_relu(d->at(y, tile.x0), block.out.at(y, tile.x0),
                                                      block.out.at(y, tile.x0), row);
                    });
        d = &block.out;
    }
}

void GatedDecoder::join(const GatedLevel& level, const PaddedMap& h, const PaddedMap& below,
                        std::size_t l, TileRunner& runner) noexcept {
    Level& joined = levels_[l];
    join_doubled(level.mask(), levels_[l + 1].touched, joined.touched);
    spread(joined);
    runner.over(level.tiles(), joined.touched, [&](std::size_t, const Tile& tile, float* scratch) {
        join_tile(h, below, joined, tile, scratch);
    });
}

/// d_l = relu(up.l * [up2(d_{l+1}); h_l])
void GatedDecoder::join_tile(const PaddedMap& h, const PaddedMap& below, Level& level,
                             const Tile& tile, float* scratch) noexcept {
    const std::ptrdiff_t mine = h.channels(), deeper = below.channels(), step = mine + deeper;
    const std::ptrdiff_t row = (tile.width() + 2) * step;
    const Tile near = tile.grown(1, h.height(), h.width());
    if (near.height() < tile.height() + 2 || near.width() < tile.width() + 2)
        std::memset(scratch, 0, std::size_t((tile.height() + 2) * row) * sizeof(float));
    for (int y = near.y0; y < near.y1; ++y) {
        float* to = scratch + (y - tile.y0 + 1) * row + (near.x0 - tile.x0 + 1) * step;
        double_row(below, y, near.x0, near.x1, to, step);
        vector_kernels().spread(h.at(y, near.x0), to + deeper, step, int(mine), near.width());
    }
    level.up.run({scratch, row, level.d.at(tile.y0, tile.x0), level.d.pitch(), mine, tile.height(),
                  tile.width()},
                 scratch + (tile.height() + 2) * row);
}

}  // namespace eventide
