// The gated encoder in tiles: what a frame costs follows how much of it moved.
#pragma once

#include "src/model/cores.h"
#include "src/nn/gru_tiles.h"
#include "src/nn/packed_layers.h"
#include "src/nn/padded_map.h"
#include "src/nn/tiling.h"

#include <vector>

namespace eventide {

class FastGatedEncoder final : public EncoderCore {
public:
    FastGatedEncoder(const Model& model, int height, int width, const EngineOptions& options,
                     bool bf16);

    std::string description() const override;
    void step(const Array3<float>& grid, Array3<float>& latent) noexcept override;
    void reset() noexcept override;
    Tensors state() const override;
    void restore(const Tensors& state) override;

private:
    struct Level {
        int side = 0;  // of its tiles, at most
        std::vector<Tile> tiles;
        PackedConv in;  // from the grid, or from the level above
        bool recurrent = false;
        GruTiles gru;
        std::vector<FloatBuffer> held;  // next state of a level that is not recurrent, per tile
        PackedConv up;
        PaddedMap state,
            decoded;         // h_l and d_l; the last level's decoded map is that of the blocks
        Mask mask, touched;  // m_l; where anything d_l reads has changed
    };
    struct Block {
        PackedConv first, second;
        PaddedMap inner, out;
    };

    void mark_events(const Array3<float>& grid) noexcept;
    void advance(std::size_t l, const Array3<float>& grid) noexcept;
    void advance_tile(Level& level, std::size_t l, std::size_t i, const Array3<float>& grid,
                      float* scratch) noexcept;
    void feed(const Level& level, std::size_t l, const Tile& region, const Array3<float>& grid,
              float* out, std::ptrdiff_t pitch, std::ptrdiff_t step, float* scratch) noexcept;
    void read_out() noexcept;
    void decode_tile(Level& level, const PaddedMap& below, const Tile& tile,
                     float* scratch) noexcept;
    const PaddedMap& decoded(std::size_t l) const;
    /// Grows `touched` by a convolution's reach and calls body for the tiles in it.
    template <typename Body>
    void over_touched(const Level& level, Mask& touched, const Body& body) noexcept;
    int collect(const Level& level, const Mask& mask) noexcept;

    ModelConfig config_;
    EngineOptions options_;
    bool bf16_;
    std::vector<Level> levels_;
    std::vector<Block> blocks_;
    PackedConv out_;
    PaddedMap latent_;
    Mask out_touched_;
    std::vector<Mask> mask_scratch_;    // per level
    std::vector<int> active_;           // numbers of the tiles at work
    std::vector<FloatBuffer> scratch_;  // per lane
    bool stale_ = true;                 // the maps behind the states are not those of the states
};

}  // namespace eventide
