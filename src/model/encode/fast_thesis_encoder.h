// The thesis' encoder in tiles. Its norms look at the whole image, so nothing can be left out.
#pragma once

#include "src/model/encode/fast_encoder.h"
#include "src/nn/load_weights.h"
#include "src/nn/packed_layers.h"

#include <vector>

namespace eventide {

class FastThesisEncoder final : public FastEncoder {
public:
    FastThesisEncoder(const Model& model, int height, int width, const EngineOptions& options,
                      const Arithmetic& arithmetic);

    void step(const VoxelGrid& grid, LatentMap& latent) noexcept override;
    void reset() noexcept override;

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

    int channels_;
    std::vector<Tile> tiles_, half_tiles_;
    PackedConv in_, res_[2], down_, head_[3];
    std::vector<plain::NormWeights<float>> norms_;
    ConvGru full_gru_, half_gru_;
    PaddedMap x0_, inner_, x2_, y0_, y1_;
    Array3<float> raw_;
    std::vector<double> sums_;          // [tile][sum, sum of squares][C]
    std::vector<float> scale_, shift_;  // [C]
};

}  // namespace eventide
