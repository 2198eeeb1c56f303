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
                                   const EngineOptions& options, bool bf16)
    : config_(model.config), options_(options), bf16_(bf16) {
    const auto conv = [&](const std::string& name, int stride, bool relu) {
        return PackedConv{plain::conv_weights<float>(model.weights, name), stride, relu, bf16};
    };
    const auto sizes = plain::level_sizes(height, width, config_.levels());
    const auto last = std::size_t(config_.latent_stride - 1);
    std::size_t scratch = 0, most_tiles = 0;
    for (std::size_t l = 0; l < sizes.size(); ++l) {
        const auto [rows, columns] = sizes[l];
        const int channels = config_.widths[l];
        Level& level = levels_.emplace_back();
        level.side = side_of(int(l));
        level.tiles = tiles_of(rows, columns, level.side);
        level.in = l == 0 ? conv("encoder.in", 1, true) : conv(named("down", l), 2, true);
        level.recurrent = config_.recurrent[l] != 0;
        if (level.recurrent)
            level.gru = {plain::gru_weights<float>(model.weights, named("gru", l)), level.tiles,
                         level.side, bf16};
        else
            for (const Tile& tile : level.tiles)
                level.held.emplace_back(std::size_t(tile.height()) * std::size_t(tile.width()) *
                                        std::size_t(channels));
        level.state = {rows, columns, channels};
        level.mask = level.touched = {rows, columns};
        mask_scratch_.push_back(level.mask);
        if (l >= last && l + 1 < sizes.size()) {
            level.up = conv(named("up", l), 1, true);
            level.decoded = {rows, columns, channels};
        }

        const int side = level.side;
        const int inputs = l == 0 ? config_.input_channels() : config_.widths[l - 1];
        const int joined = channels + (l + 1 < sizes.size() ? config_.widths[l + 1] : channels);
        const auto area = [](int n) { return std::size_t(n) * std::size_t(n); };
        // The grid's tile, or [up2; h], or what a convolution narrows; then what the GRU needs.
        const std::size_t source = 2 * area(2 * side + 10) * std::size_t(inputs);
        const std::size_t read_out =
            2 * area(side + 2) * std::size_t(std::max(joined, 2 * channels));
        scratch = std::max(scratch, source + read_out + level.gru.scratch_size());
        most_tiles = std::max(most_tiles, level.tiles.size());
    }
    const auto [rows, columns] = sizes.back();
    for (std::size_t i = 0; i < std::size_t(config_.res_blocks); ++i)
        blocks_.push_back({conv(named("res", i) + ".0", 1, true),
                           conv(named("res", i) + ".1", 1, false),
                           {rows, columns, config_.widths.back()},
                           {rows, columns, config_.widths.back()}});
    out_ = conv("encoder.out", 1, false);
    latent_ = {sizes[last].first, sizes[last].second, config_.latent};
    out_touched_ = levels_[last].mask;
    active_.reserve(most_tiles);
    scratch_.assign(kLanes, FloatBuffer(scratch));
}

std::string FastGatedEncoder::description() const {
    return std::string{"fast, "} + (bf16_ ? "bf16 (AVX512_BF16)" : vector_kernels().name);
}

void FastGatedEncoder::step(const Array3<float>& grid, Array3<float>& latent) noexcept {
    mark_events(grid);
    for (std::size_t l = 0; l < levels_.size(); ++l) advance(l, grid);
    read_out();
    latent_.save(latent.values().data());
}

void FastGatedEncoder::mark_events(const Array3<float>& grid) noexcept {
    Level& top = levels_[0];
    for (int y = 0; y < grid.height(); ++y) {
        const float* pixel = grid.pixel(y, 0).data();
        for (int x = 0; x < grid.width(); ++x, pixel += grid.channels()) {
            bool any = false;
            for (int b = 0; b < config_.bins; ++b) any |= pixel[4 * b + 3] != 0;
            top.mask(y, x) = std::uint8_t(any);
        }
    }
    dilate(top.mask, config_.gate_radius, mask_scratch_[0], top.mask);
    for (std::size_t l = 1; l < levels_.size(); ++l) halve(levels_[l - 1].mask, levels_[l].mask);
}

int FastGatedEncoder::collect(const Level& level, const Mask& mask) noexcept {
    active_.clear();
    for (std::size_t i = 0; i < level.tiles.size(); ++i)
        if (!options_.skip_quiet || level.tiles[i].any(mask)) active_.push_back(int(i));
    return int(active_.size());
}

void FastGatedEncoder::advance(std::size_t l, const Array3<float>& grid) noexcept {
    Level& level = levels_[l];
    const int count = collect(level, level.mask);
    for_each_tile(options_.parallel_for, count, [&](int lane, int n) {
        advance_tile(level, l, std::size_t(active_[std::size_t(n)]), grid,
                     scratch_[std::size_t(lane)].data());
    });
    for_each_tile(options_.parallel_for, count, [&](int, int n) {
        const auto i = std::size_t(active_[std::size_t(n)]);
        if (level.recurrent) {
            level.gru.commit(level.state, i);
            return;
        }
        const Tile& tile = level.tiles[i];
        const auto c = std::size_t(level.state.channels());
        const float* next = level.held[i].data();
        for (int y = tile.y0; y < tile.y1; ++y)
            for (int x = tile.x0; x < tile.x1; ++x, next += c)
                if (level.mask(y, x) != 0)
                    std::memcpy(level.state.at(y, x), next, c * sizeof(float));
    });
}

void FastGatedEncoder::advance_tile(Level& level, std::size_t l, std::size_t i,
                                    const Array3<float>& grid, float* scratch) noexcept {
    if (level.recurrent) {
        float* source = scratch + level.gru.scratch_size();
        level.gru.step(level.state, i, &level.mask, scratch, [&](const GruTiles::Target& target) {
            feed(level, l, target.region, grid, target.out, target.pitch, target.step, source);
        });
        return;
    }
    const Tile& tile = level.tiles[i];
    const std::ptrdiff_t c = level.state.channels();
    feed(level, l, tile, grid, level.held[i].data(), tile.width() * c, c, scratch);
}

/// a_l in a region.
void FastGatedEncoder::feed(const Level& level, std::size_t l, const Tile& region,
                            const Array3<float>& grid, float* out, std::ptrdiff_t pitch,
                            std::ptrdiff_t step, float* scratch) noexcept {
    if (l > 0) {
        const PaddedMap& above = levels_[l - 1].state;
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
void FastGatedEncoder::over_touched(const Level& level, Mask& touched, const Body& body) noexcept {
    if (!stale_) dilate(touched, 1, mask_scratch_[std::size_t(&level - levels_.data())], touched);
    const int count = collect(level, touched);
    for_each_tile(options_.parallel_for, count, [&](int lane, int n) {
        body(level.tiles[std::size_t(active_[std::size_t(n)])], scratch_[std::size_t(lane)].data());
    });
}

const PaddedMap& FastGatedEncoder::decoded(std::size_t l) const {
    if (l + 1 < levels_.size()) return levels_[l].decoded;
    return blocks_.empty() ? levels_[l].state : blocks_.back().out;
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
    const PaddedMap* d = &deepest.state;
    for (Block& block : blocks_) {
        over_touched(deepest, deepest.touched, [&](const Tile& tile, float* scratch) {
            conv(block.first, *d, block.inner, tile, scratch);
        });
        over_touched(deepest, deepest.touched, [&](const Tile& tile, float* scratch) {
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
        for (int y = 0; y < level.mask.height(); ++y)
            for (int x = 0; x < level.mask.width(); ++x) {
                const int y1 = std::min((y + 1) / 2, below.height() - 1);
                const int x1 = std::min((x + 1) / 2, below.width() - 1);
                level.touched(y, x) =
                    std::uint8_t(level.mask(y, x) | below(y / 2, x / 2) | below(y / 2, x1) |
                                 below(y1, x / 2) | below(y1, x1));
            }
        const PaddedMap& from = decoded(l + 1);
        over_touched(level, level.touched, [&](const Tile& tile, float* scratch) {
            decode_tile(level, from, tile, scratch);
        });
    }
    Level& level = levels_[last];
    std::ranges::copy(level.touched.values(), out_touched_.values().begin());
    over_touched(level, out_touched_, [&](const Tile& tile, float* scratch) {
        conv(out_, decoded(last), latent_, tile, scratch);
    });
    stale_ = false;
}

/// d_l = relu(up.l * [up2(d_{l+1}); h_l])
void FastGatedEncoder::decode_tile(Level& level, const PaddedMap& below, const Tile& tile,
                                   float* scratch) noexcept {
    const PaddedMap& h = level.state;
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
    for (Level& level : levels_) level.state.clear();
    stale_ = true;
}

Tensors FastGatedEncoder::state() const {
    Tensors state;
    for (std::size_t l = 0; l < levels_.size(); ++l) {
        const PaddedMap& h = levels_[l].state;
        Tensor& tensor = state["h." + std::to_string(l)];
        tensor.shape = {h.height(), h.width(), h.channels()};
        tensor.values.resize(element_count(tensor.shape));
        h.save(tensor.values.data());
    }
    return state;
}

void FastGatedEncoder::restore(const Tensors& state) {
    for (std::size_t l = 0; l < levels_.size(); ++l)
        levels_[l].state.load(state.at("h." + std::to_string(l)).values.data());
    stale_ = true;
}

}  // namespace eventide
