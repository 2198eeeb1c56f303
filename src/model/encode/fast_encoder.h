// What both fast encoders have: states that are saved and loaded, scratch memory for each worker,
// and an account of when which tile of the codes changed, so that a map that was filled before is
// only renewed. Codes are written where they are handed out; no copy is kept.
#pragma once

#include "src/model/cores.h"
#include "src/nn/arithmetic.h"
#include "src/nn/conv_gru.h"
#include "src/nn/padded_map.h"
#include "src/nn/state_map.h"
#include "src/nn/tile_runner.h"

#include <vector>

namespace eventide {

class FastEncoder : public EncoderCore {
public:
    std::string description() const override;
    Tensors state() const override;
    void restore(const Tensors& state) override;

protected:
    FastEncoder(const EngineOptions& options, const Arithmetic& arithmetic);

    /// To be called once, with the size of the latent map, the scratch numbers a worker needs, and
    /// the most tiles any map has.
    void make_room(int height, int width, std::size_t scratch, std::size_t tiles);
    /// Tile i of the map of codes has new values in this step.
    void mark_changed(std::size_t i) noexcept { history_.changed[i] = history_.step; }
    /// Whether tile i of `latent` is not what it would be made of now.
    bool is_outdated(std::size_t i, const LatentMap& latent) const noexcept;

    EngineOptions options_;
    Arithmetic arithmetic_;
    std::vector<StateMap> states_;  // h_l
    std::vector<Tile> latent_tiles_;
    LatentHistory history_;  // of the codes; `step` is the one at work
    TileRunner runner_;
    bool stale_ = true;  // what follows from the states is not that of the states
};

/// Which tiles of a copy are out of date: those that changed since, or all.
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

}  // namespace eventide
