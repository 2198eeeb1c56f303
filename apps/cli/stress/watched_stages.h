// The model's stages, with double precision walking along.
#pragma once

#include "apps/cli/stress/double_network.h"
#include "apps/cli/stress/double_renderer.h"
#include "pipeline/model_render_stage.h"
#include "src/model/encode/encoder.h"

#include <deque>
#include <memory>

namespace eventide::stress {

/// Which event windows are also encoded in double precision: the first ones, and `segment` in a row
/// every `period`, which begin with what the engine remembers then.
struct Sampling {
    std::uint64_t first = 100;
    std::uint64_t segment = 4, period = 50;
    std::uint64_t frames_every = 7;  ///< of the frames in such windows, one in so many
    static Sampling none() { return {0, 0, 1, 1}; }
};

/// What the two kinds of stages share. One thread: for Pipeline::run_sequential().
class Judge {
public:
    Judge(const Model& model, int width, int height, const Sampling& sampling);

    void before_encoding(const Encoder& encoder);
    void encoded(const VoxelGrid& grid, const LatentMap& latent);
    void rendered(SensorTime t, const Window& window, const RenderRequest& request,
                  const Frame& frame);
    void reset();
    void note_state(const TensorFile& state);

    const Distance& codes() const { return codes_; }
    const Distance& frames() const { return frames_; }
    double largest_state() const { return largest_state_; }  ///< of recurrent levels

private:
    bool judges(std::uint64_t window) const;

    struct Known {
        Window window;
        Array3<double> codes;
    };
    ModelConfig config_;
    int width_, height_;
    Sampling sampling_;
    std::unique_ptr<DoubleNetwork> network_;
    DoubleRenderer renderer_;
    std::deque<Known> known_;  // the newest few event windows
    std::uint64_t windows_ = 0, rendered_ = 0;
    bool judging_ = false;
    Distance codes_, frames_;
    double largest_state_ = 0;
};

class JudgedEncodeStage final : public EncodeStage {
public:
    /// `judge` may be null.
    JudgedEncodeStage(Encoder& encoder, Judge* judge) : encoder_(encoder), judge_(judge) {}
    LatentMap make_output() const override { return encoder_.make_output(); }
    void reset() noexcept override;

private:
    void step(const VoxelGrid& grid, LatentMap& latent) noexcept override;
    Encoder& encoder_;
    Judge* judge_;
};

class JudgedRenderStage final : public RenderStage {
public:
    JudgedRenderStage(Renderer& renderer, const RenderRequest& request, Judge* judge)
        : stage_{renderer, request}, request_{request}, judge_{judge} {}
    Frame make_output() const override { return stage_.make_output(); }
    void take(LatentMap& latent) noexcept override { stage_.take(latent); }
    void finish() noexcept override { stage_.finish(); }
    void reset() noexcept override { stage_.reset(); }
    void render(SensorTime t, const Window& window, Frame& frame) noexcept override {
        stage_.render(t, window, frame);
        if (judge_ != nullptr) judge_->rendered(t, window, request_, frame);
    }

private:
    ModelRenderStage stage_;
    RenderRequest request_;
    Judge* judge_;
};

}  // namespace eventide::stress
