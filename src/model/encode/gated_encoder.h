// The gated encoder in tiles: what an event window costs follows how much of it moved.
#pragma once

#include "src/model/cores.h"
#include "src/model/encode/gated_decoder.h"
#include "src/model/encode/gated_level.h"
#include "src/model/encode/latent_tiles.h"
#include "src/nn/tile_runner.h"

#include <vector>

namespace eventide {

class GatedEncoder final : public EncoderCore {
public:
    GatedEncoder(const Model& model, int height, int width, const EngineOptions& options,
                 const Backend& backend);

    std::string description() const override;
    bool gives_bf16() const override { return backend_.bf16 != nullptr; }
    void step(const VoxelGrid& grid, LatentCodes& latent) noexcept override;
    void reset() noexcept override;
    Tensors state() const override { return tensors_of(states_); }
    void restore(const Tensors& state) override;

private:
    /// Fills the levels' masks; false where nothing happened anywhere.
    bool mark_events(const VoxelGrid& grid) noexcept;
    void advance(GatedLevel& level, const Array3<float>& grid) noexcept;

    ModelConfig config_;
    EngineOptions options_;
    Backend backend_;
    // Levels from the top (full resolution) to the deepest; states_[l] is that of levels_[l].
    std::vector<GatedLevel> levels_;
    std::vector<StateMap> states_;  // h_l
    GatedDecoder decoder_;
    LatentTiles latent_;
    TileRunner runner_;
    bool stale_ = true;             // what follows from the states is not that of the states
    Mask top_room_, deepest_room_;  // to dilate the masks with
};

}  // namespace eventide
