// One step of a convolutional GRU, with or without a reset gate, tile by tile.
#pragma once

#include "src/kernels/plain/activations.h"
#include "src/nn/packed_conv.h"
#include "src/nn/state_map.h"
#include "src/nn/tiling.h"

#include <vector>

namespace eventide {

/// Steps of neighbouring tiles read each other's old state, so a step has two halves: step() of all
/// tiles writes aside, commit() of all tiles brings it into the map.
class ConvGru {
public:
    /// Where step() wants a's pixels, in the numbers that layers read: the region's first pixel is
    /// at `out`, with `pitch` units between rows.
    struct Target {
        Tile region;
        float* out;
        std::ptrdiff_t pitch;
    };

    ConvGru() = default;
    /// For maps of height x width cut into `tiles`, each at most `side` x `side`. `held`: at any
    /// time only so many consecutive tiles are between step() and commit(); 0: all of them.
    ConvGru(const plain::GruWeights<float>& weights, Extent map, const std::vector<Tile>& tiles,
            int side, const Backend& backend, std::size_t held = 0);

    /// Pixels around a tile that step() reads of its input; 0 of an empty one.
    int reach() const { return reach_; }
    /// Scratch numbers step() needs.
    std::size_t scratch_size() const;
    /// fill(Target) writes a (C numbers per pixel) into the target's region, which is the tile
    /// grown by reach() within the map.
    /// A state in bf16 is advanced where it is exact, which no other tile reads.
    template <typename Fill>
    void step(StateMap& state, std::size_t i, const Mask* mask, float* scratch,
              const Fill& fill) noexcept {
        const Tile near = tiles_[i].grown(reach_, state.height(), state.width());
        begin(i, scratch, near);
        fill(Target{near, input_at(scratch, i, near.y0, near.x0), input_pitch()});
        finish(state, i, mask, scratch);
    }
    void commit(StateMap& state, std::size_t i) noexcept;

private:
    int units() const { return gates_.numbers().units(channels_); }
    bool has_reset() const { return reach_ == 2; }
    int input_side() const { return side_ + 2 * reach_; }
    int gates_side() const { return input_side() - 2; }
    std::ptrdiff_t input_pitch() const { return std::ptrdiff_t(input_side()) * units(); }
    std::ptrdiff_t kept_pitch() const { return std::ptrdiff_t(side_ + 2) * units(); }
    std::ptrdiff_t gates_pitch() const { return std::ptrdiff_t(gates_side()) * 2 * channels_; }
    /// a around tile i starts reach() pixels up and left of it; the gates 1 less, what they keep of
    /// the state 1 pixel.
    float* input_at(float* input, std::size_t i, int y, int x) const {
        return input + (y - tiles_[i].y0 + reach_) * input_pitch() +
               std::ptrdiff_t(x - tiles_[i].x0 + reach_) * units();
    }
    float* kept_at(float* kept, std::size_t i, int y, int x) const {
        return kept + (y - tiles_[i].y0 + 1) * kept_pitch() +
               std::ptrdiff_t(x - tiles_[i].x0 + 1) * units();
    }
    /// A pixel's gates are u_0 .. u_{C-1}, then r_0 .. r_{C-1}; without a reset gate, what the
    /// candidate comes from.
    float* gates_at(float* gates, std::size_t i, int y, int x) const {
        return gates + (y - tiles_[i].y0 + reach_ - 1) * gates_pitch() +
               std::ptrdiff_t(x - tiles_[i].x0 + reach_ - 1) * 2 * channels_;
    }
    void begin(std::size_t i, float* scratch, const Tile& near) const noexcept;
    void finish(StateMap& state, std::size_t i, const Mask* mask, float* scratch) noexcept;
    void keep(const StateMap& state, std::size_t i, const Tile& close, float* gates,
              float* kept) const noexcept;
    void update(const StateMap& state, std::size_t i, const Mask* mask, float* gates,
                float* candidate) noexcept;
    void update_light(const StateMap& state, std::size_t i, const Mask* mask,
                      float* halves) noexcept;
    void update_rounded(StateMap& state, std::size_t i, const Mask* mask, float* gates,
                        const float* candidate) noexcept;
    void keep_unmasked(const PaddedMap& state, const Mask& mask, int y, const Tile& tile,
                       float* next) const noexcept;

    int channels_ = 0, side_ = 0, reach_ = 0;
    std::vector<Tile> tiles_;
    PackedConv gates_, candidate_;   // without a reset gate the first is both
    std::vector<FloatBuffer> next_;  // of tile i in i % size, [y][x][C] as layers read it
};

}  // namespace eventide
