// The implicit decoder in blocks of pixels: layer 1's convolution kept per latent map, the layers
// behind it run while their numbers are in cache.
#pragma once

#include "src/model/cores.h"
#include "src/model/fast_encoder.h"
#include "src/nn/gru_tiles.h"
#include "src/nn/packed_layers.h"
#include "src/nn/padded_map.h"
#include "src/nn/tiling.h"

#include <array>
#include <vector>

namespace eventide {

class FastRenderer final : public RendererCore {
public:
    FastRenderer(const Model& model, int sensor_width, int sensor_height,
                 const EngineOptions& options, const Arithmetic& arithmetic);

    std::string description() const override;
    void push(std::int64_t k, const LatentMap& latent) noexcept override;
    void reset() noexcept override;
    void render(const CodeChoice& codes, const PictureGeometry& picture, SigmaRule rule,
                Array2<float>& intensity, Array2<float>* sigma) noexcept override;

private:
    /// Layer 1 without its offset part, at every sample of event frame k.
    struct Hoisted {
        std::int64_t k = 0;  // 0: nothing yet
        bool whole = false;  // over z_{k-1..k+1}; else over z_{k-1}, z_k
        Array3<float> sums;
    };
    /// What a picture's columns read; the same for all its rows.
    struct Columns {
        // By side: the pixels that use their left (0) or right (1) sample.
        std::array<std::vector<int>, 2> pixel, column;
        std::array<std::vector<float>, 2> offset, weight;
    };
    /// One member of the local ensemble for a whole row: a sample row, and what its offset adds.
    struct Member {
        const float* sums;  // the sample row
        const float* base;  // [H_1], the time and row part of layer 1's offset term
        float weight;       // of time and row
        std::size_t side;   // left or right
    };

    bool around(int tile, const Outdated& since) const noexcept;
    const Hoisted& hoist(std::int64_t k, bool whole, const Hoisted* keep) noexcept;
    bool unchanged(const Hoisted& from, std::int64_t k, bool whole,
                   std::size_t tile) const noexcept;
    void hoist_tile(Hoisted& to, const Tile& tile, float* scratch) noexcept;
    /// z_k, which must be kept; null before the first, which reads as zeros.
    const PaddedMap* code(std::int64_t k) const noexcept;
    void lay_out_columns(const PictureGeometry& picture) noexcept;
    void render_row(const CodeChoice& codes, const PictureGeometry& picture,
                    const std::array<const Hoisted*, 2>& hoisted, int row, SigmaRule rule,
                    float* intensity, float* sigma, std::size_t lane) noexcept;
    /// Adds a member's part to the three sums of every pixel of the row.
    void evaluate(const Member& member, float* blended, int width, float* scratch) const noexcept;
    /// The hidden layers behind the first; `room` holds 2 kBlock widest_ numbers. Returns where the
    /// result is.
    const float* run_layers(const float* activations, int pixels, float* room) const noexcept;

    ModelConfig config_;
    EngineOptions options_;
    Arithmetic arithmetic_;
    int height_, width_;  // of the latent maps
    int first_ = 0, widest_ = 0;
    PackedConv past_, whole_;
    std::vector<PackedWeights> layers_;           // hidden layers behind the first
    std::array<std::vector<float>, 3> slope_;     // layer 1's columns for t, x, y
    std::vector<float> last_weight_, last_bias_;  // [2][H], [2]

    std::vector<Tile> tiles_;
    int tile_columns_ = 0;
    std::array<PaddedMap, LatentWindow::kLatentsKept> codes_;
    std::array<LatentHistory, LatentWindow::kLatentsKept> histories_;  // of the codes
    /// Per event frame (k % size), per tile: whether z_k differs from z_{k-1} in the tile's reach.
    static constexpr std::int64_t kChangesKept = 16;
    std::array<std::vector<std::uint8_t>, kChangesKept> changed_;
    std::int64_t newest_ = 0;
    std::array<Hoisted, 2> hoisted_;
    Columns columns_;
    PictureGeometry laid_out_;
    bool needs_squares_ = false;
    std::vector<int> active_;
    std::vector<FloatBuffer> scratch_, row_sums_;  // per lane
};

}  // namespace eventide
