// The thesis' encoder in tiles. Its norms look at the whole image, so nothing can be left out.
#pragma once

#include "src/model/cores.h"
#include "src/model/encode/latent_tiles.h"
#include "src/nn/conv_gru.h"
#include "src/nn/load_weights.h"
#include "src/nn/packed_conv.h"
#include "src/nn/padded_map.h"
#include "src/nn/state_map.h"
#include "src/nn/tile_runner.h"

#include <vector>

namespace eventide {

class ThesisEncoder final : public EncoderCore {
public:
    ThesisEncoder(const Model& model, int height, int width, const EngineOptions& options,
                  const Backend& backend);

    std::string description() const override;
    void step(const VoxelGrid& grid, LatentCodes& latent) noexcept override;
    void reset() noexcept override;
    Tensors state() const override { return tensors_of(states_); }
    void restore(const Tensors& state) override { load(state, states_); }

private:
    /// raw_ = conv of `from`, with each tile's sums for the norm.
    void convolve(const PackedConv& conv, const PaddedMap& from) noexcept;
    void keep_sums(std::size_t tile) noexcept;
    /// to = elu(norm(raw_) + skip); skip may be null.
    void normalise(std::size_t norm, const PaddedMap* skip, PaddedMap& to) noexcept;
    void feed_in(const Array3<float>& grid) noexcept;
    void step_full() noexcept;
    void step_half() noexcept;
    void join_head() noexcept;
    ConvCall into_raw(const Tile& tile, const float* in, std::ptrdiff_t pitch) noexcept;

    Backend backend_;
    int channels_;
    LatentTiles latent_;  // one way of cutting for all maps of full size
    std::vector<Tile> half_tiles_;
    TileRunner runner_;
    std::vector<StateMap> states_;  // h0 at full, h1 at half resolution
    PackedConv in_, res_[2], down_, head_[3];
    std::vector<plain::NormWeights<float>> norms_;
    ConvGru full_gru_, half_gru_;
    PaddedMap x0_, inner_, x2_, y0_, y1_;
    Array3<float> raw_;
    // Of raw_, written by the worker that writes the tile; added up in the order of tiles, so that
    // no bit depends on threads.
    std::vector<double> sums_;          // [tile][sum, sum of squares][C]
    std::vector<float> scale_, shift_;  // [C]
};

}  // namespace eventide
