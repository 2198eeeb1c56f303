// What the pipeline asks of whatever makes latent maps of voxel grids.
#pragma once

#include "src/core/frame_data.h"

namespace eventide {

/// grid + state -> latent map. One thread at a time.
class EncodeStage {
public:
    virtual ~EncodeStage() = default;
    virtual LatentMap make_output() const = 0;
    /// `latent` is from make_output(): its values become those of this grid, and it says what the
    /// grid does of its event window.
    void encode(const VoxelGrid& grid, LatentMap& latent) noexcept {
        step(grid, latent);
        copy_stamp(grid, latent);
    }
    virtual void reset() noexcept = 0;  ///< as constructed

private:
    /// Fills `latent.values` and, where it is known, `latent.history`.
    virtual void step(const VoxelGrid& grid, LatentMap& latent) noexcept = 0;
};

}  // namespace eventide
