// The gated encoder in tiles: what a frame costs follows how much of it moved.
#pragma once

#include "src/model/encode/fast_encoder.h"
#include "src/model/encode/gated_decoder.h"
#include "src/model/encode/gated_level.h"

#include <vector>

namespace eventide {

class FastGatedEncoder final : public FastEncoder {
public:
    FastGatedEncoder(const Model& model, int height, int width, const EngineOptions& options,
                     const Arithmetic& arithmetic);

    void step(const VoxelGrid& grid, LatentMap& latent) noexcept override;
    void reset() noexcept override;

private:
    /// Fills the levels' masks; false where nothing happened anywhere.
    bool mark_events(const VoxelGrid& grid) noexcept;
    void advance(GatedLevel& level, const Array3<float>& grid) noexcept;

    ModelConfig config_;
    std::vector<GatedLevel> levels_;
    GatedDecoder decoder_;
    Mask top_room_, deepest_room_;  // to dilate the masks with
};

}  // namespace eventide
