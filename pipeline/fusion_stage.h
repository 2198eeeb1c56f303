// The model as the render stage of the pipeline, corrected by the images that the source gives.
#pragma once

#include "pipeline/stages.h"
#include "src/model/fused_renderer.h"

#include <algorithm>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>

namespace eventide {

/// Images on their way from the bin thread to the render thread, by their number in the stream. Of
/// more than kKept the oldest are dropped.
class ImagesOnTheWay {
public:
    static constexpr std::size_t kKept = 64;

    void put(const std::vector<ReferenceImage>& images) {
        const std::lock_guard lock{mutex_};
        for (const ReferenceImage& image : images) images_.push_back(image);
        given_ += images.size();
        while (images_.size() > kKept) images_.pop_front();
    }

    /// The next one of those before number `end`.
    std::optional<ReferenceImage> take(std::uint64_t end) {
        const std::lock_guard lock{mutex_};
        if (images_.empty() || given_ - images_.size() >= end) return std::nullopt;
        std::optional<ReferenceImage> image{std::move(images_.front())};
        images_.pop_front();
        return image;
    }

private:
    std::mutex mutex_;
    std::deque<ReferenceImage> images_;
    std::uint64_t given_ = 0;
};

/// Needs LatentMap::events_per_pixel and that every image of the source is put into `images`.
class FusionRenderStage final : public RenderStage {
public:
    FusionRenderStage(Renderer& renderer, const RenderRequest& request, int sensor_width,
                      int sensor_height, ImagesOnTheWay& images)
        : renderer_(renderer),
          request_(request),
          fused_(renderer, sensor_width, sensor_height, request.lookahead),
          images_(images) {
        fused_.prepare(request_);
    }

    Frame make_output() const override { return renderer_.make_output(request_); }
    void push(const LatentMap& latent) noexcept override {
        renderer_.push(latent);
        while (auto image = images_.take(latent.images))
            if (!latent.reset_before) fused_.give(std::move(*image));  // else of the old clock
        fused_.push(latent.window, latent.events_per_pixel);
    }
    void finish() noexcept override { renderer_.finish(); }
    void reset() noexcept override {
        renderer_.reset();
        fused_.reset();
    }
    void render(SensorTime t, const Window& window, Frame& frame) noexcept override {
        // As ModelRenderStage.
        request_.t = std::max(t, window.begin + SensorDuration{1});
        fused_.render(request_, frame);
    }
    bool change_lookahead(int lookahead) override {
        request_.lookahead = lookahead;
        fused_.change_lookahead(lookahead);
        return true;
    }
    bool change_size(int width, int height, Frame& frame) override {
        RenderRequest request = request_;
        request.width = width;
        request.height = height;
        frame = renderer_.make_output(request);
        fused_.prepare(request);
        request_ = request;
        return true;
    }

    /// After the run.
    const FusedRenderer& fused() const { return fused_; }

private:
    Renderer& renderer_;
    RenderRequest request_;
    FusedRenderer fused_;
    ImagesOnTheWay& images_;
};

}  // namespace eventide
