// The fast ConvGRU: [a; h] of a tile and its surroundings stays in cache from gates to new state.
#include "src/nn/conv_gru.h"

#include "src/kernels/vector_kernels.h"

#include <algorithm>
#include <cstring>

namespace eventide {

ConvGru::ConvGru(const plain::GruWeights<float>& weights, Extent map,
                 const std::vector<Tile>& tiles, int side, const Arithmetic& arithmetic)
    : channels_(weights.candidate.out),
      side_(side),
      tiles_(tiles),
      gates_(weights.gates, 1, false, arithmetic, extents_of(tiles, 1, map.height, map.width)),
      candidate_(weights.candidate, 1, false, arithmetic,
                 extents_of(tiles, 0, map.height, map.width)) {
    for (const Tile& tile : tiles_)
        next_.emplace_back(std::size_t(tile.height()) * std::size_t(tile.width()) *
                           std::size_t(channels_));
}

// Scratch: [a; h] of side + 4, then gates of side + 2, then the candidate, then the convolutions'.
std::size_t ConvGru::scratch_size() const {
    const auto square = [](int n) { return std::size_t(n) * std::size_t(n); };
    const auto c = std::size_t(channels_);
    return square(side_ + 4) * 2 * c + square(side_ + 2) * 2 * c + square(side_) * c +
           std::max(gates_.scratch_size(side_ + 2, side_ + 2),
                    candidate_.scratch_size(side_, side_));
}

float* ConvGru::begin(std::size_t i, float* scratch, const Tile& near) const noexcept {
    const Tile& tile = tiles_[i];
    const bool inside = near.height() == tile.height() + 4 && near.width() == tile.width() + 4;
    // What lies outside the map reads as zero.
    if (!inside)
        std::memset(scratch, 0,
                    std::size_t(side_ + 4) * std::size_t(joined_pitch()) * sizeof(float));
    return scratch;
}

void ConvGru::finish(const PaddedMap& state, std::size_t i, const Mask* mask, const Tile& near,
                     float* joined) noexcept {
    const VectorKernels& kernels = vector_kernels();
    const Tile& tile = tiles_[i];
    const std::ptrdiff_t c = channels_;
    float* gates = joined + (side_ + 4) * joined_pitch();
    const std::ptrdiff_t gates_pitch = (side_ + 2) * 2 * c;
    float* candidate = gates + (side_ + 2) * gates_pitch;
    const std::ptrdiff_t candidate_pitch = side_ * c;
    float* scratch = candidate + side_ * candidate_pitch;

    for (int y = near.y0; y < near.y1; ++y)
        kernels.spread(state.at(y, near.x0), joined_at(joined, i, y, near.x0) + c, 2 * c, channels_,
                       near.width());

    const Tile close = tile.grown(1, state.height(), state.width());
    const auto gate_at = [&](int y, int x) {
        return gates + (y - tile.y0 + 1) * gates_pitch + (x - tile.x0 + 1) * 2 * c;
    };
    gates_.run({joined_at(joined, i, close.y0 - 1, close.x0 - 1), joined_pitch(),
                gate_at(close.y0, close.x0), gates_pitch, 2 * c, close.height(), close.width()},
               scratch);
    for (int y = close.y0; y < close.y1; ++y)
        kernels.reset_state(gate_at(y, close.x0) + c, 2 * c, joined_at(joined, i, y, close.x0) + c,
                            2 * c, channels_, close.width());

    candidate_.run({joined_at(joined, i, tile.y0 - 1, tile.x0 - 1), joined_pitch(), candidate,
                    candidate_pitch, c, tile.height(), tile.width()},
                   scratch);
    float* next = next_[i].data();
    for (int y = tile.y0; y < tile.y1; ++y, next += tile.width() * c) {
        const float* row = candidate + (y - tile.y0) * candidate_pitch;
        kernels.update_state(state.at(y, tile.x0), gate_at(y, tile.x0), 2 * c, row, next, channels_,
                             tile.width());
        if (mask != nullptr) keep_unmasked(state, *mask, y, tile, next);
    }
}

/// States outside the mask stay as they are, bit for bit.
void ConvGru::keep_unmasked(const PaddedMap& state, const Mask& mask, int y, const Tile& tile,
                            float* next) const noexcept {
    const auto c = std::size_t(channels_);
    for (int x = tile.x0; x < tile.x1; ++x, next += c)
        if (mask(y, x) == 0) std::memcpy(next, state.at(y, x), c * sizeof(float));
}

void ConvGru::commit(PaddedMap& state, std::size_t i) noexcept {
    const Tile& tile = tiles_[i];
    const auto row = std::size_t(tile.width()) * std::size_t(channels_);
    const float* next = next_[i].data();
    for (int y = tile.y0; y < tile.y1; ++y, next += row)
        std::memcpy(state.at(y, tile.x0), next, row * sizeof(float));
}

}  // namespace eventide
