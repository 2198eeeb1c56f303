// The renderer's first layer at every latent sample, kept from frame to frame: of its inputs
// only the offset belongs to a query, so all else is a convolution over latent maps, done once per
// event window and again only where a code changed.
#pragma once

#include "src/model/cores.h"
#include "src/model/encode/latent_tiles.h"
#include "src/nn/packed_conv.h"
#include "src/nn/padded_map.h"
#include "src/nn/tiling.h"

#include <array>
#include <cstdint>
#include <vector>

namespace eventide {

/// One thread at a time; nothing is allocated after construction.
///
///     z_{k-2}    z_{k-1}    z_k    z_{k+1}    z_{k+2}       codes_[k % 5]
///                [- past_: 2 -]                             sums of event window k, not `whole`
///                [----- whole_: 3 ------]                   sums of event window k, `whole`
///                           [----- whole_: 3 ------]        sums of event window k + 1
///
/// A frame blends two event windows, hence two maps of sums. changed_ says per event window and
/// tile whether z_k is another than z_{k-1}, and so which of the sums still hold.
class FirstLayerCache {
public:
    /// Layer 1 without its offset part, at every sample of event window k.
    struct WindowSums {
        std::int64_t k = 0;  ///< 0: nothing yet
        bool whole = false;  ///< over z_{k-1..k+1}; else over z_{k-1}, z_k
        /// [y][x][H_1] in latent pixels, of the numbers that layers read
        Array3<float> values;
    };

    /// Latent maps are of `height` x `width`.
    FirstLayerCache(const Model& model, int height, int width, const EngineOptions& options,
                    const Backend& backend);

    /// Takes z_k; k - 1 before it, unless reset() was.
    void push(std::int64_t k, const LatentCodes& latent) noexcept;
    /// The same; z_{k-5}, which goes, is left in place of z_k where no copy is needed.
    void take(std::int64_t k, LatentCodes& latent) noexcept;
    void reset() noexcept;

    /// The sums of event window k; valid until the call after the next.
    const WindowSums& at(std::int64_t k, bool whole) noexcept { return bring(k, whole, nullptr); }
    /// Those of k and of k + 1 together.
    std::array<const WindowSums*, 2> pair(std::int64_t k, bool whole, bool next_whole) noexcept;

    /// Whether every code that the samples of a tile read is the same in all of z_from .. z_to.
    bool still(std::size_t tile, std::int64_t from, std::int64_t to) const noexcept;

private:
    bool is_as_held(const LatentCodes& latent) const noexcept;
    const WindowSums* find(std::int64_t k, bool whole) const noexcept;
    const WindowSums& bring(std::int64_t k, bool whole, const WindowSums* keep) noexcept;
    void compute_tile(WindowSums& to, const Tile& tile, float* scratch) noexcept;
    bool around(int tile, const StaleTiles& since) const noexcept;
    bool unchanged(const WindowSums& from, std::int64_t k, bool whole,
                   std::size_t tile) const noexcept;
    /// Writes a tile of z_k; where still_codes allows, z_{k-1} as it is held in its place, so that
    /// what is held never drifts further off.
    void hold_tile(std::int64_t k, const Tile& tile, const LatentCodes& latent,
                   float* rows) noexcept;
    bool is_still(const PaddedMap& before, const Tile& tile, const LatentCodes& latent,
                  float* rows) const noexcept;
    void note_changes(std::int64_t k, const LatentHistory& history) noexcept;
    /// z_k as layers read it, which must be kept; null before the first, which reads as zeros.
    const PaddedMap* code(std::int64_t k) const noexcept;

    EngineOptions options_;
    int height_, width_, depth_, outputs_;
    int reach_;  ///< px, of the first layer: 1, or 0 where it reads codes in time alone
    std::vector<Tile> tiles_;
    int tile_columns_ = 0;
    Numbers numbers_;
    PackedConv past_, whole_;  // over two and three codes, each in its own map
    std::array<PaddedMap, LatentWindow::kLatentsKept> codes_;
    PaddedMap zeros_;                                                  // a row of them
    std::array<LatentHistory, LatentWindow::kLatentsKept> histories_;  // of the codes
    /// Per event window (k % size), per tile: whether z_k differs from z_{k-1} in the tile's reach.
    static constexpr std::int64_t kChangesKept = 16;
    std::array<std::vector<std::uint8_t>, kChangesKept> changed_;
    std::vector<std::int64_t> newest_change_;  // per tile: the last such k, however long ago
    std::int64_t newest_ = 0;
    std::array<WindowSums, 2> kept_;
    std::vector<int> active_;           // tiles to be computed
    std::vector<FloatBuffer> scratch_;  // per worker
};

}  // namespace eventide
