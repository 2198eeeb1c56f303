// The model as the pipeline's render stage, corrected by the camera's own images where they are
// given.
#pragma once

#include "pipeline/counters.h"
#include "pipeline/images_on_the_way.h"
#include "pipeline/stages.h"
#include "src/model/render/fused_renderer.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace eventide {

class ModelRenderStage final : public RenderStage {
public:
    /// `request` holds for all frames, except for its `t`; its lookahead is the pipeline's.
    ModelRenderStage(Renderer& renderer, const RenderRequest& request)
        : renderer_(renderer), request_(request) {}
    /// Frames are corrected by `images`, into which every image of the source is put; needs
    /// LatentMap::events_per_pixel.
    ModelRenderStage(Renderer& renderer, const RenderRequest& request, int sensor_width,
                     int sensor_height, ImagesOnTheWay& images)
        : renderer_(renderer),
          request_(request),
          images_(&images),
          fused_(std::in_place, renderer, sensor_width, sensor_height, request.lookahead) {
        fused_->keep_at_most(std::min(images.most(), FusedRenderer::kMaxWaitingOfRecording));
        fused_->prepare(request_);
    }

    Frame make_output() const override { return renderer_.make_output(request_); }
    void take(LatentMap& latent) noexcept override {
        renderer_.take(latent);
        correct(latent);
    }
    void finish() noexcept override { renderer_.finish(); }
    void reset() noexcept override {
        renderer_.reset();
        if (!fused_) return;
        fused_->reset();
        note_images();
    }
    void render(SensorTime t, const Window& window, Frame& frame) noexcept override {
        // The stream's first frame may stand at the first window's begin, which is outside it.
        request_.t = std::max(t, window.begin + SensorDuration{1});
        if (!fused_) return renderer_.render(request_, frame);
        fused_->render(request_, frame);
        note_images();
    }
    bool change_lookahead(int lookahead) override {
        request_.lookahead = lookahead;
        if (fused_) fused_->change_lookahead(lookahead);
        return true;
    }
    bool change_size(int width, int height, Frame& frame) override {
        RenderRequest request = request_;
        request.width = width;
        request.height = height;
        Frame changed = renderer_.make_output(request);
        if (fused_) fused_->prepare(request);
        request_ = request;
        frame = std::move(changed);
        return true;
    }

    /// After the run; null where no images are taken.
    const FusedRenderer* fused() const { return fused_ ? &*fused_ : nullptr; }
    /// Thread: any. Images that corrected frames, and those that came too late for it, or were too
    /// many to be kept.
    std::uint64_t used_images() const { return used_.value(); }
    std::uint64_t dropped_images() const {
        return fused_ ? images_->dropped() + dropped_.value() : 0;
    }

private:
    /// Gives the correction the images that came before the map's window was cut, then the window.
    void correct(const LatentMap& latent) noexcept {
        if (!fused_) return;
        fused_->give_all([&] { return images_->take(latent.images); });
        fused_->push(latent.window, latent.events_per_pixel);
        note_images();
    }
    void note_images() noexcept {
        used_.set(fused_->used());
        dropped_.set(fused_->dropped());
    }

    Renderer& renderer_;
    RenderRequest request_;
    ImagesOnTheWay* images_ = nullptr;
    std::optional<FusedRenderer> fused_;
    Counter used_, dropped_;  // images
};

}  // namespace eventide
