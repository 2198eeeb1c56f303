// The recurrent network: one voxel grid in, one latent map out, with a state that remembers.
#pragma once

#include "src/core/encode_stage.h"
#include "src/model/engine.h"
#include "src/model/model_file.h"

#include <memory>
#include <string>
#include <vector>

namespace eventide {

class EncoderCore;

/// One thread at a time. After construction nothing fails, and with Engine::fast nothing is
/// allocated.
class Encoder final : public EncodeStage {
public:
    /// For a sensor of width x height pixels (1 to kLargestSensorSide each). Throws Error where the
    /// model does not hold together or the precision is not there.
    Encoder(const Model& model, int width, int height, const EngineOptions& options = {});
    ~Encoder() override;
    Encoder(Encoder&&) noexcept;
    Encoder& operator=(Encoder&&) noexcept;

    int width() const { return width_; }
    int height() const { return height_; }
    /// Bins per event window the grids must have.
    int bins() const { return bins_; }
    /// Which kernels and numbers run, for reports: "fast, bf16 (AVX512_BF16)".
    std::string description() const;

    LatentMap make_output() const override;
    /// Back to the state after construction.
    void reset() noexcept override;

    /// The hidden state with the identity of the model and the sensor's size, to go on from later
    /// (write_safetensors keeps it as a file).
    TensorFile state() const;
    /// Throws Error(input) naming `name` and what differs, where the state is of another model,
    /// another sensor size, or damaged; the encoder is then as it was.
    void restore(const TensorFile& state, const std::string& name);

private:
    /// `grid` is [height][width][4 bins + 1].
    void step(const VoxelGrid& grid, LatentMap& latent) noexcept override;

    int width_, height_, bins_;
    int latent_height_ = 0, latent_width_ = 0, latent_channels_ = 0;
    std::string identity_;  // encoder_identity() of the model, which saved states carry
    // One for each view of the ensemble (kMirrors).
    std::vector<std::unique_ptr<EncoderCore>> cores_;
    VoxelGrid mirrored_;  // the grid as a view sees it
};

}  // namespace eventide
