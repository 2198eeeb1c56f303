// See gated_level.h; docs/model.md has the formulas.
#include "src/model/encode/gated_level.h"

#include "src/kernels/vector_kernels.h"
#include "src/nn/load_weights.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace eventide {
namespace {

/// Small enough that a tile's maps stay in a core's own cache, large enough that borders computed
/// twice cost little. Deeper levels have more channels and smaller maps.
/// A tile of levels 0 to 3 so covers 48, 48, 64 and 96 px of the sensor on a side; what lies deeper
/// has tiles of 12, too.
constexpr int kSides[] = {48, 24, 16, 12};

/// Enough tiles for all threads, few enough that not every tile's next state is held at once.
constexpr std::size_t kLeastGroup = 32;

/// The input layer's channels in maps of one quad of units or two, where layers go by quads and not
/// too many channels of zeros have to be added; else in one, whose pixels fill a cache line or an
/// even part of it where layers go by lines.
///
///     channels         21 (5 bins)      9 (2 bins)
///     float32          3 maps of 8      3 maps of 4
///     bf16             3 maps of 8      1 of 9, as 2 maps of 8 would add too many
///     bf16, by lines   1 of 32          1 of 16
struct InputMaps {
    int count = 1, size = 0;
};
InputMaps input_maps(int channels, const Backend& backend) {
    constexpr double kMaxAdded = 1.34;  // pixels in pairs, the other way, cost as much
    const Numbers numbers{backend};
    const bool is_bf16 = numbers.bf16() != nullptr;
    InputMaps best{1, channels};
    if (backend.onednn) return best;
    if (is_bf16 && numbers.bf16()->by_lines) {
        constexpr unsigned kLine = 32;  // numbers
        if (channels <= int(kLine)) best.size = int(std::bit_ceil(unsigned(channels)));
        return best;
    }
    if (!numbers.by_quads()) return best;
    for (const int size : {4, 8}) {
        const int count = (channels + size - 1) / size;
        if ((is_bf16 && size == 4) || count > ConvArea::kMaxSources) continue;
        if (count * size > kMaxAdded * channels) continue;
        best = {count, size};
        break;
    }
    return best;
}

/// With zeros for channels that are not there: (outputs x inputs x taps) to (outputs x more inputs
/// x taps), an output's weights in front.
plain::ConvWeights<float> with_inputs(const plain::ConvWeights<float>& weights, int inputs) {
    plain::ConvWeights<float> wider{weights.out, inputs, {}, weights.bias, weights.side};
    const std::size_t taps = std::size_t(weights.side) * std::size_t(weights.side),
                      before = std::size_t(weights.in) * taps, after = std::size_t(inputs) * taps;
    wider.weight.resize(std::size_t(weights.out) * after);
    for (std::size_t o = 0; o < std::size_t(weights.out); ++o)
        std::copy_n(weights.weight.begin() + std::ptrdiff_t(o * before), before,
                    wider.weight.begin() + std::ptrdiff_t(o * after));
    return wider;
}

}  // namespace

std::string encoder_layer(const char* part, std::size_t i) {
    return "encoder." + std::string{part} + "." + std::to_string(i);
}

GatedLevel::GatedLevel(const Model& model, std::size_t number, Extent size, const Backend& backend)
    : number_(number),
      size_(size),
      channels_(model.config.widths[number]),
      inputs_(number == 0 ? model.config.input_channels() : model.config.widths[number - 1]),
      side_(kSides[std::min(number, std::size(kSides) - 1)]),
      tiles_(tiles_of(size.height, size.width, side_)),
      recurrent_(model.config.recurrent[number] != 0),
      mask_(size.height, size.width) {
    make_gru(model, backend);
    const auto weights = plain::conv_weights<float>(
        model.weights, number == 0 ? "encoder.in" : encoder_layer("down", number));
    const InputMaps maps = number == 0 ? input_maps(inputs_, backend) : InputMaps{1, inputs_};
    maps_ = maps.count;
    map_channels_ = maps.size;
    in_ = {with_inputs(weights, maps_ * map_channels_),
           number == 0 ? 1 : 2,
           true,
           backend,
           extents_of(tiles_, gru_.reach(), size.height, size.width),
           std::vector<int>(std::size_t(maps_), map_channels_),
           maps_ > 1 ? Summation::as_one : Summation::best};
}

void GatedLevel::make_gru(const Model& model, const Backend& backend) {
    if (!recurrent_) return;
    // 640x480: 14 tiles a row of tiles, so groups of 3 rows, 42 tiles.
    const auto row = std::size_t(std::ranges::count(tiles_, tiles_.front().y0, &Tile::y0));
    group_ = row * ((kLeastGroup + row - 1) / row);
    gru_ = {plain::gru_weights<float>(model.weights, encoder_layer("gru", number_)),
            size_,
            tiles_,
            side_,
            backend,
            2 * group_};
}

// A worker's scratch, one piece behind the other:
//
//     recurrent    ConvGru's (conv_gru.cpp) | what feed() needs
//     held         the next state of a tile | what feed() needs
//     feed()       top: the grid, [map][y][x][channels] with a rim | a row of it, then in_'s
//                  below: in_'s
std::size_t GatedLevel::scratch_size() const {
    const int side = side_ + 2 * gru_.reach();
    const auto wide = std::size_t(side + 2);
    const std::size_t grid =
        number_ == 0 ? wide * wide * std::size_t(maps_ * in_.numbers().units(map_channels_)) : 0;
    const std::size_t row = number_ == 0 ? wide * std::size_t(inputs_) : 0;
    const std::size_t next = recurrent_ ? gru_.scratch_size() : next_size();
    return next + grid + std::max(row, in_.scratch_size(side, side));
}

void GatedLevel::advance(const Array3<float>& grid, std::vector<StateMap>& states, std::size_t i,
                         float* scratch) noexcept {
    if (recurrent_) {
        float* rest = scratch + gru_.scratch_size();
        gru_.step(states[number_], i, &mask_, scratch,
                  [&](const Target& target) { feed(grid, states, target, rest); });
        return;
    }
    const Tile& tile = tiles_[i];
    // h <- h + m (a - h), m 0 or 1. Written at once, as no tile of this level reads h: the level
    // below and the decoder do, later.
    feed(grid, states, {tile, scratch, std::ptrdiff_t(tile.width()) * units()},
         scratch + next_size());
    write(states[number_].read(), tile, scratch);
}

void GatedLevel::commit(std::vector<StateMap>& states, std::size_t i) noexcept {
    gru_.commit(states[number_], i);
}

void GatedLevel::write(PaddedMap& h, const Tile& tile, const float* next) const noexcept {
    const auto u = std::size_t(units()), row = std::size_t(tile.width()) * u;
    for (int y = tile.y0; y < tile.y1; ++y, next += row) {
        if (std::memchr(&mask_(y, tile.x0), 0, std::size_t(tile.width())) == nullptr) {
            std::memcpy(h.at(y, tile.x0), next, row * sizeof(float));
            continue;
        }
        for (int x = tile.x0; x < tile.x1; ++x)
            if (mask_(y, x) != 0)
                std::memcpy(h.at(y, x), next + std::size_t(x - tile.x0) * u, u * sizeof(float));
    }
}

/// a_l in a region:
///
/// a_0 = relu(in * T(grid)), a_l = relu(down.l * h_{l-1}) with stride 2, so that output (y, x) is
/// centred on (2 y, 2 x) of the level above, and its first input is (2 y - 1, 2 x - 1).
void GatedLevel::feed(const Array3<float>& grid, const std::vector<StateMap>& states,
                      const Target& target, float* scratch) const noexcept {
    if (number_ == 0) {
        feed_grid(grid, target, scratch);
        return;
    }
    const PaddedMap& above = states[number_ - 1].read();
    const Tile& region = target.region;
    in_.run(ConvArea{.in = {{{above.at(2 * region.y0 - 1, 2 * region.x0 - 1), above.pitch()}}},
                     .out = target.out,
                     .out_pitch = target.pitch,
                     .to_bf16 = true,
                     .height = region.height(),
                     .width = region.width()},
            scratch);
}

/// Of the compressed grid around the region, zeros outside the sensor. A tile in the grid's upper
/// left corner, as the convolution reads it from scratch:
///
///     0 0 0 0 0 0      r: the region, for whose pixels the layer puts something out; of a level
///     0 r r r r g      that remembers, the tile and 2 more on each side within the map
///     0 r r r r g      (conv_gru.cpp)
///     0 r r r r g      g: a rim of one pixel, which the 3x3 layer reads; 0: past the sensor's edge
///     0 g g g g g      rows of [pixel][channel], one after the other, `row` units each; behind
///                      them one row in float32, where layers read bf16. Where layers go by
///                      quads, channels 0 to 7 lie so, behind them those from 8 on, ...
void GatedLevel::feed_grid(const Array3<float>& grid, const Target& target,
                           float* scratch) const noexcept {
    const Tile& region = target.region;
    const Tile wide = region.widened(1);
    const Tile inside = region.grown(1, grid.height(), grid.width());
    const Numbers& numbers = in_.numbers();
    const int channels = grid.channels();
    const std::ptrdiff_t units = numbers.units(map_channels_), row = wide.width() * units,
                         plane = wide.height() * row;
    for (int map = 0; map < maps_; ++map)
        clear_outside(wide, inside, scratch + map * plane, row, units);
    float* rest = scratch + maps_ * plane;
    for (int y = inside.y0; y < inside.y1; ++y) {
        const std::ptrdiff_t ahead =
            to_row_ahead(inside, y, std::ptrdiff_t(grid.width()) * channels);
        const float* from = grid.pixel(y, inside.x0).data();
        float* to = scratch + (y - wide.y0) * row + (inside.x0 - wide.x0) * units;
        if (numbers.bf16() != nullptr) {
            numbers.bf16()->compress_row({.in = from,
                                          .pixels = inside.width(),
                                          .channels = channels,
                                          .ahead = ahead,
                                          .out = to,
                                          .size = 2 * int(units),
                                          .maps = maps_,
                                          .plane = plane});
            continue;
        }
        numbers.kernels().compress(from, maps_ > 1 ? rest : to,
                                   std::size_t(inside.width()) * std::size_t(channels), ahead);
        if (maps_ > 1)
            avx512::split_pixels({rest, inside.width(), channels, map_channels_, maps_, to, plane});
    }
    // Maps past maps_ are named, too, and not read.
    in_.run(ConvArea{.in = {{{scratch, row}, {scratch + plane, row}, {scratch + 2 * plane, row}}},
                     .out = target.out,
                     .out_pitch = target.pitch,
                     .to_bf16 = true,
                     .height = region.height(),
                     .width = region.width()},
            rest);
}

}  // namespace eventide
