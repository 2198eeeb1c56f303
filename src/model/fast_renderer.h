// The implicit decoder in blocks of pixels: layer 1 is kept per latent map (hoisted_layer.h), the
// layers behind it run while their numbers are in cache.
#pragma once

#include "src/model/hoisted_layer.h"

#include <array>
#include <vector>

namespace eventide {

class FastRenderer final : public RendererCore {
public:
    FastRenderer(const Model& model, int sensor_width, int sensor_height,
                 const EngineOptions& options, const Arithmetic& arithmetic);

    std::string description() const override;
    void make_room(const PictureGeometry& picture) override { lay_out_columns(picture); }
    void push(std::int64_t k, const LatentMap& latent) noexcept override;
    void reset() noexcept override;
    void render(const CodeChoice& codes, const PictureGeometry& picture, SigmaRule rule,
                Array2<float>& intensity, Array2<float>* sigma) noexcept override;

private:
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

    AxisSamples time_samples(const CodeChoice& codes) const noexcept;
    void lay_out_columns(const PictureGeometry& picture);
    void render_row(const CodeChoice& codes, const PictureGeometry& picture,
                    const std::array<const HoistedLayer::Sums*, 2>& hoisted, int row,
                    SigmaRule rule, float* intensity, float* sigma, std::size_t lane) noexcept;
    /// Adds a member's part to the three sums of every pixel of the row.
    void evaluate(const Member& member, float* blended, int width, float* scratch) const noexcept;
    /// The hidden layers behind the first; `room` holds 2 kBlock widest_ numbers. Returns where the
    /// result is.
    const float* run_layers(const float* activations, int pixels, float* room) const noexcept;

    ModelConfig config_;
    EngineOptions options_;
    Arithmetic arithmetic_;
    int first_ = 0, widest_ = 0;  // outputs of layer 1, of the widest layer
    HoistedLayer hoisted_;
    std::vector<PackedWeights> layers_;           // hidden layers behind the first
    std::array<std::vector<float>, 3> slope_;     // layer 1's columns for t, x, y
    std::vector<float> last_weight_, last_bias_;  // [2][H], [2]

    Columns columns_;
    PictureGeometry laid_out_;
    bool needs_squares_ = false;
    std::vector<FloatBuffer> scratch_, row_sums_;  // per lane
};

}  // namespace eventide
