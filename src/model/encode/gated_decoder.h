// The gated encoder's way up: from the levels' states to latent codes, renewed where what they are
// made of may have changed.
#pragma once

#include "src/model/encode/gated_level.h"
#include "src/nn/tile_runner.h"

#include <vector>

namespace eventide {

/// Where it works anew, by masks (level l has 1/2^l of the resolution):
///
///     touched, of the deepest level     its mask, spread by 1 px for each layer of the blocks
///     of level l                        its mask or what up2 reads of level l + 1's, spread by 1
///     of the top                        spread by 1 more, for `out` where it is: where codes may
///                                       have changed
///
/// After a layer whose outputs are rounded by groups (PackedConv::group()), filled up to whole
/// ones.
///
/// A tile without a touched pixel is left out; its numbers are those of the last run().
class GatedDecoder {
public:
    GatedDecoder(const Model& model, const std::vector<GatedLevel>& levels, const Backend& backend);

    /// Size of the map of codes that write_codes() writes.
    Extent latent_size() const { return latent_size_; }

    /// Numbers run() needs for each worker.
    std::size_t scratch_size() const { return scratch_; }

    /// Brings everything before the codes up to the states, where a level's mask says that one has
    /// changed, or `everywhere`.
    void run(const std::vector<GatedLevel>& levels, const std::vector<StateMap>& states,
             bool everywhere, TileRunner& runner) noexcept;
    /// Whether codes of a tile may have changed in the last run().
    bool changes(const Tile& tile) const { return tile.any(levels_[top_].touched); }
    /// A tile of the map of codes.
    void write_codes(const std::vector<StateMap>& states, const Tile& tile, Array3<float>& codes,
                     float* scratch) const noexcept;

private:
    struct Level {
        Mask touched, room;  // where d_l may have changed; to spread it with
        PackedConv up;
        PaddedMap d;  // d_l; of the deepest level that of the blocks counts
    };
    struct Block {
        PackedConv first, second;
        PaddedMap inner, out;  // as layers read them
        PaddedMap sum;         // d in float32
    };

    static void convolve(const PackedConv& conv, const PaddedMap& from, PaddedMap& to, bool to_bf16,
                         const Tile& tile, float* scratch) noexcept;
    void add(const PaddedMap& before, bool is_float, Block& block, const Tile& tile,
             float* scratch) const noexcept;
    /// Grows `touched` by 1 px each way, as far as a convolution reads.
    static void spread(Level& level) noexcept;
    void run_blocks(const GatedLevel& deepest, const PaddedMap& h, bool everywhere,
                    TileRunner& runner) noexcept;
    void join(const GatedLevel& level, const PaddedMap& h, const PaddedMap& below, std::size_t l,
              TileRunner& runner) noexcept;
    void join_tile(const PaddedMap& h, const PaddedMap& below, std::size_t l, const Tile& tile,
                   float* scratch) noexcept;
    const PaddedMap& decoded(std::size_t l, const std::vector<StateMap>& states) const;

    std::size_t top_;  // the level that codes come from
    bool has_out_;     // else its map is the codes
    std::vector<int> widths_;
    Numbers numbers_;
    std::vector<Level> levels_;
    std::vector<Block> blocks_;
    PackedConv out_;
    Extent latent_size_;
    std::size_t scratch_ = 0;
};

}  // namespace eventide
