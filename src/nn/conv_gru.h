// One step of a convolutional GRU, tile by tile.
#pragma once

#include "src/kernels/plain/activations.h"
#include "src/nn/packed_layers.h"
#include "src/nn/padded_map.h"
#include "src/nn/tiling.h"

#include <vector>

namespace eventide {

using FloatBuffer = std::vector<float, CacheLineAllocator<float>>;

/// Steps of neighbouring tiles read each other's old state, so a step has two halves: step() of all
/// tiles writes aside, commit() of all tiles brings it into the map.
class ConvGru {
public:
    /// Where step() wants a's pixels: [y][x] with `pitch` numbers between rows and `step` between
    /// pixels; the region's first pixel is at `out`.
    struct Target {
        Tile region;
        float* out;
        std::ptrdiff_t pitch, step;
    };

    ConvGru() = default;
    /// For maps of height x width cut into `tiles`, each at most `side` x `side`.
    ConvGru(const plain::GruWeights<float>& weights, Extent map, const std::vector<Tile>& tiles,
            int side, const Arithmetic& arithmetic);

    /// Scratch numbers step() needs.
    std::size_t scratch_size() const;
    /// fill(Target) writes a (C numbers per pixel) into the target's region, which is the tile
    /// grown by 2 within the map.
    template <typename Fill>
    void step(const PaddedMap& state, std::size_t i, const Mask* mask, float* scratch,
              const Fill& fill) noexcept {
        const Tile near = tiles_[i].grown(2, state.height(), state.width());
        float* joined = begin(i, scratch, near);
        fill(Target{near, joined_at(joined, i, near.y0, near.x0), joined_pitch(),
                    2 * std::ptrdiff_t(channels_)});
        finish(state, i, mask, near, joined);
    }
    void commit(PaddedMap& state, std::size_t i) noexcept;

private:
    std::ptrdiff_t joined_pitch() const { return std::ptrdiff_t(side_ + 4) * 2 * channels_; }
    /// [a; h] around tile i starts 2 pixels up and left of it.
    float* joined_at(float* joined, std::size_t i, int y, int x) const {
        return joined + (y - tiles_[i].y0 + 2) * joined_pitch() +
               std::ptrdiff_t(x - tiles_[i].x0 + 2) * 2 * channels_;
    }
    float* begin(std::size_t i, float* scratch, const Tile& near) const noexcept;
    void finish(const PaddedMap& state, std::size_t i, const Mask* mask, const Tile& near,
                float* joined) noexcept;
    void keep_unmasked(const PaddedMap& state, const Mask& mask, int y, const Tile& tile,
                       float* next) const noexcept;

    int channels_ = 0, side_ = 0;
    std::vector<Tile> tiles_;
    PackedConv gates_, candidate_;
    std::vector<FloatBuffer> next_;  // per tile, [y][x][C]
};

}  // namespace eventide
