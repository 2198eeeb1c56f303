// When which tile of an encoder's codes changed, so that a map that was filled before is only
// renewed. Codes are written where they are handed out; no copy is kept.
#pragma once

#include "src/core/frame_data.h"
#include "src/nn/tiling.h"

#include <vector>

namespace eventide {

/// Which tiles of a copy are out of date: those that changed since, or all.
///
///     step           1    2    3    4    5
///     tile 7 new          x              x        now.changed[7] = 5
///     a copy of step 4 is stale in tile 7; one of step 5, or of 6, is not
class StaleTiles {
public:
    StaleTiles(const LatentHistory& copy, const LatentHistory& now)
        : now_(now), since_(copy.step), known_(now.source != 0 && copy.source == now.source) {}
    bool operator()(std::size_t tile) const { return !known_ || now_.changed[tile] > since_; }

private:
    const LatentHistory& now_;
    std::uint64_t since_;
    bool known_;
};

class LatentTiles {
public:
    /// For a map of height x width codes.
    LatentTiles(int height, int width);

    const std::vector<Tile>& tiles() const { return tiles_; }
    /// In which step each tile last changed; its `step` is the one at work.
    const LatentHistory& history() const { return history_; }

    void begin_step() noexcept { ++history_.step; }
    /// Tile i has new codes in this step.
    void mark_changed(std::size_t i) noexcept { history_.changed[i] = history_.step; }
    /// Whether tile i of `latent` is not what it would be made of now.
    bool is_outdated(std::size_t i, const LatentCodes& latent) const noexcept {
        return StaleTiles{latent.history, history_}(i);
    }

private:
    std::vector<Tile> tiles_;
    LatentHistory history_;
};

}  // namespace eventide
