// The model as stages of the pipeline.
#pragma once

#include "pipeline/stages.h"
#include "src/model/encoder.h"
#include "src/model/renderer.h"

#include <algorithm>

namespace eventide {

class ModelEncodeStage final : public EncodeStage {
public:
    explicit ModelEncodeStage(Encoder& encoder) : encoder_(encoder) {}
    LatentMap make_output() const override { return encoder_.make_output(); }
    void encode(const VoxelGrid& grid, LatentMap& latent) noexcept override {
        encoder_.encode(grid, latent);
    }
    void reset() noexcept override { encoder_.reset(); }

private:
    Encoder& encoder_;
};

class ModelRenderStage final : public RenderStage {
public:
    /// Of the request everything but `t` holds for all frames; its lookahead is the pipeline's.
    ModelRenderStage(Renderer& renderer, const RenderRequest& request)
        : renderer_(renderer), request_(request) {}
    Frame make_output() const override { return renderer_.make_output(request_); }
    void push(const LatentMap& latent) noexcept override { renderer_.push(latent); }
    void finish() noexcept override { renderer_.finish(); }
    void reset() noexcept override { renderer_.reset(); }
    void render(SensorTime t, const Window& window, Frame& frame) noexcept override {
        // The stream's first frame may stand at the first window's begin, which is outside it.
        request_.t = std::max(t, window.begin + SensorDuration{1});
        renderer_.render(request_, frame);
    }
    bool change_lookahead(int lookahead) override {
        request_.lookahead = lookahead;
        return true;
    }
    bool change_size(int width, int height, Frame& frame) override {
        RenderRequest request = request_;
        request.width = width;
        request.height = height;
        frame = renderer_.make_output(request);
        request_ = request;
        return true;
    }

private:
    Renderer& renderer_;
    RenderRequest request_;
};

}  // namespace eventide
