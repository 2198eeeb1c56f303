// The gated encoder in tiles: what a frame costs follows how much of it moved.
#pragma once

#include "src/model/fast_encoder.h"
#include "src/nn/packed_layers.h"

#include <vector>

namespace eventide {

class FastGatedEncoder final : public FastEncoder {
public:
    FastGatedEncoder(const Model& model, int height, int width, const EngineOptions& options,
                     const Arithmetic& arithmetic);

    void step(const VoxelGrid& grid, LatentMap& latent) noexcept override;
    void reset() noexcept override;

private:
    struct Level {
        std::size_t number = 0;
        int side = 0;  // of its tiles, at most
        std::vector<Tile> tiles;
        PackedConv in;  // from the grid, or from the level above
        bool recurrent = false;
        GruTiles gru;
        std::vector<FloatBuffer> held;  // next state of a level that is not recurrent, per tile
        PackedConv up;
        PaddedMap decoded;   // d_l; the last level's is that of the blocks
        Mask mask, touched;  // m_l; where anything d_l reads has changed
    };
    struct Block {
        PackedConv first, second;
        PaddedMap inner, out;
    };

    std::size_t make_level(const Model& model, std::size_t l, Extent size);
    /// Fills the masks; false where nothing happened anywhere.
    bool mark_events(const VoxelGrid& grid) noexcept;
    void advance(std::size_t l, const Array3<float>& grid) noexcept;
    void advance_tile(Level& level, std::size_t l, std::size_t i, const Array3<float>& grid,
                      float* scratch) noexcept;
    void feed(const Level& level, std::size_t l, const Tile& region, const Array3<float>& grid,
              float* out, std::ptrdiff_t pitch, std::ptrdiff_t step, float* scratch) noexcept;
    void read_out() noexcept;
    void decode_tile(Level& level, const PaddedMap& below, const Tile& tile,
                     float* scratch) noexcept;
    const PaddedMap& decoded(std::size_t l) const;
    /// Grows `touched` by a convolution's reach and calls body(i, tile, scratch) for those of the
    /// tiles it reaches.
    template <typename Body>
    void over_touched(const std::vector<Tile>& tiles, Mask& touched, Mask& room,
                      const Body& body) noexcept;
    template <typename Body>
    void over_touched(Level& level, const Body& body) noexcept {
        over_touched(level.tiles, level.touched, mask_scratch_[level.number], body);
    }
    int collect(const std::vector<Tile>& tiles, const Mask& mask) noexcept;

    ModelConfig config_;
    std::vector<Level> levels_;
    std::vector<Block> blocks_;
    PackedConv out_;
    Mask out_touched_;
    std::vector<Mask> mask_scratch_;  // per level
    std::vector<int> active_;         // numbers of the tiles at work
};

}  // namespace eventide
