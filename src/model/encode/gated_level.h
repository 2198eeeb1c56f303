// One level of the gated encoder on the way down: what it takes in, and what it remembers of it.
#pragma once

#include "src/model/model_file.h"
#include "src/nn/conv_gru.h"
#include "src/nn/packed_conv.h"
#include "src/nn/state_map.h"

#include <string>
#include <vector>

namespace eventide {

/// "encoder.PART.I"
std::string encoder_layer(const char* part, std::size_t i);

/// A recurrent level's step reads neighbouring tiles' old state, so it has two halves: advance() of
/// all tiles writes aside, commit() of all tiles brings it into the map. Others have no commit().
class GatedLevel {
public:
    GatedLevel(const Model& model, std::size_t number, Extent size, const Backend& backend);

    const Extent& size() const { return size_; }
    int side() const { return side_; }  ///< of its tiles, at most
    const std::vector<Tile>& tiles() const { return tiles_; }
    /// m_l, whose filling is the encoder's business.
    Mask& mask() { return mask_; }
    const Mask& mask() const { return mask_; }

    /// Numbers advance() needs.
    std::size_t scratch_size() const;
    bool is_recurrent() const { return recurrent_; }
    /// How many consecutive tiles, in whole rows, go together in a recurrent level. commit() of
    /// such a group comes after advance() of the next one, and before advance() of the one after
    /// that.
    std::size_t group() const { return group_; }
    /// The next state of tile i. `states`: those of all levels; the top one reads `grid`.
    void advance(const Array3<float>& grid, std::vector<StateMap>& states, std::size_t i,
                 float* scratch) noexcept;
    void commit(std::vector<StateMap>& states, std::size_t i) noexcept;

private:
    using Target = ConvGru::Target;
    void make_gru(const Model& model, const Backend& backend);
    int units() const { return in_.numbers().units(channels_); }
    /// Numbers of a tile's next state.
    std::size_t next_size() const { return std::size_t(side_ * side_ * units()); }
    void feed(const Array3<float>& grid, const std::vector<StateMap>& states, const Target& target,
              float* scratch) const noexcept;
    /// Into the map, where the mask says so.
    void write(PaddedMap& h, const Tile& tile, const float* next) const noexcept;
    void feed_grid(const Array3<float>& grid, const Target& target, float* scratch) const noexcept;

    std::size_t number_;
    Extent size_;
    int channels_, inputs_, side_;
    int maps_ = 1, map_channels_ = 0;  // that the layer's inputs are cut into; channels of each
    std::vector<Tile> tiles_;
    bool recurrent_;
    std::size_t group_ = 0;
    ConvGru gru_;
    PackedConv in_;  // from the grid, or from the level above
    Mask mask_;
};

}  // namespace eventide
