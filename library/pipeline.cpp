// Sources and sinks of a library's user around the pipeline.
#include "pipeline/pipeline.h"

#include "library/network_options.h"
#include "library/pushed_images.h"
#include "library/user_source.h"
#include "pipeline/model_render_stage.h"
#include "src/core/error.h"
#include "src/model/encode/encoder.h"

#include <eventide/pipeline.h>

#include <utility>

namespace eventide {

// Here, so that one object holds what their users' code refers to.
EventSource::~EventSource() = default;
FrameSink::~FrameSink() = default;

namespace {

class UserSink final : public Sink {
public:
    explicit UserSink(FrameSink& sink) : sink_(sink) {}
    void write(const Frame& frame) override { wants_more_ = sink_.write(frame); }
    void close() override { sink_.close(); }
    bool wants_more() const override { return wants_more_; }

private:
    FrameSink& sink_;
    bool wants_more_ = true;
};

/// Bin thread.
class ImagesSeen final : public DataObserver {
public:
    explicit ImagesSeen(ImagesOnTheWay& images) : images_(images) {}
    void see(const Batch& batch) override {
        std::vector<ReferenceImage> grey;
        for (const ReferenceImage& image : batch.images) grey.push_back(without_mosaic(image));
        if (!grey.empty()) images_.put(std::move(grey));
    }

private:
    ImagesOnTheWay& images_;
};

std::vector<std::unique_ptr<UserSink>> wrapped(const std::vector<FrameSink*>& sinks) {
    std::vector<std::unique_ptr<UserSink>> wrapped;
    for (FrameSink* sink : sinks) {
        if (sink == nullptr)
            throw Error(ErrorKind::usage, "pipeline: expected sinks, found a null pointer");
        wrapped.push_back(std::make_unique<UserSink>(*sink));
    }
    return wrapped;
}

RenderRequest request_of(const ReconstructorOptions& options, int width, int height) {
    check_frame_size(options.size, width, height);
    RenderRequest request;
    request.width = options.size.width;
    request.height = options.size.height;
    request.region = options.size.region;
    request.lookahead = options.lookahead;
    request.want_sigma = options.sigma;
    return request;
}

/// Longer ones are beyond what the clocks count with.
void check_latency(std::chrono::microseconds latency) {
    constexpr std::chrono::seconds kLongest{1'000'000};
    if (latency < latency.zero() || latency > kLongest)
        throw Error(ErrorKind::usage, "latency: expected 0 to " + std::to_string(kLongest.count()) +
                                          " s, found " + std::to_string(latency.count()) + " us");
}

PipelineSettings settings_of(const PipelineOptions& options, const ModelConfig& config,
                             const Source& source) {
    check_latency(options.latency);
    PipelineSettings settings;
    settings.bins = config.bins;
    settings.event_windows.slicer = slicer_of(options.frames, config);
    settings.rate = rate_of(options.frames);
    settings.lookahead = options.frames.lookahead;
    if (source.is_live() && options.latency.count() > 0) settings.latency = options.latency;
    settings.reset_on_gap = options.frames.reset_on_gap;
    settings.allow_silence = options.frames.allow_silence;
    settings.events_per_pixel = options.frames.images;
    settings.buffers = buffers_for(source);
    return settings;
}

std::chrono::microseconds us(std::chrono::nanoseconds time) {
    return std::chrono::duration_cast<std::chrono::microseconds>(time);
}

}  // namespace

class EventPipeline::Impl {
public:
    Impl(EventSource& source, const std::vector<FrameSink*>& sinks, const Model& model,
         const PipelineOptions& options, int width, int height)
        : sequential_(options.sequential),
          source_(source, options.frames.images),
          sinks_(wrapped(sinks)),
          filter_(filter_of(options.frames, model.config, width, height)),
          encoder_(model, width, height, engine_of(options.frames)),
          renderer_(model, width, height, engine_of(options.frames)),
          render_(options.frames.images
                      ? ModelRenderStage{renderer_, request_of(options.frames, width, height),
                                         width, height, kept(source)}
                      : ModelRenderStage{renderer_, request_of(options.frames, width, height)}),
          pipeline_(parts(), settings_of(options, model.config, source_)) {}

    void run() {
        if (std::exchange(ran_, true))
            throw Error(ErrorKind::usage,
                        "pipeline: expected one run, found a second; make another pipeline");
        sequential_ ? pipeline_.run_sequential() : pipeline_.run();
    }
    void stop() noexcept { pipeline_.stop(); }
    Snapshot snapshot() const { return pipeline_.snapshot(); }
    const ModelRenderStage& render() const { return render_; }

private:
    /// A recording waits for the network, so that none are too many.
    ImagesOnTheWay& kept(const EventSource& source) {
        if (source.is_live()) images_.keep_at_most(ImagesOnTheWay::kKeptLive);
        return images_;
    }
    PipelineParts parts() {
        DataObserver* observer = render_.fused() != nullptr ? &images_seen_ : nullptr;
        PipelineParts parts{source_, encoder_, render_, {}, filter_.get(), observer};
        for (const auto& sink : sinks_) parts.sinks.push_back(sink.get());
        return parts;
    }

    const bool sequential_;
    UserSource source_;
    std::vector<std::unique_ptr<UserSink>> sinks_;
    std::unique_ptr<EventFilters> filter_;
    Encoder encoder_;
    Renderer renderer_;
    ImagesOnTheWay images_;
    ImagesSeen images_seen_{images_};
    ModelRenderStage render_;
    Pipeline pipeline_;
    bool ran_ = false;
};

EventPipeline::EventPipeline(EventSource& source, const std::vector<FrameSink*>& sinks,
                             const std::string& model, const PipelineOptions& options) {
    const int width = source.info().width, height = source.info().height;
    check_sensor(width, height);
    impl_ = with_enough_memory(model, width, height, [&] {
        return std::make_unique<Impl>(source, sinks, tried_model(model), options, width, height);
    });
}
EventPipeline::~EventPipeline() = default;
EventPipeline::EventPipeline(EventPipeline&&) noexcept = default;
EventPipeline& EventPipeline::operator=(EventPipeline&&) noexcept = default;

void EventPipeline::run() {
    impl_->run();
}
void EventPipeline::stop() noexcept {
    impl_->stop();
}

PipelineCounters EventPipeline::counters() const {
    const Snapshot now = impl_->snapshot();
    return {.batches = now.packets,
            .lost_batches = now.lost_packets,
            .gaps = now.gaps,
            .events = now.events,
            .filtered = now.filtered_events,
            .damaged = now.damaged.total(),
            .event_windows = now.encoded,
            .merged_windows = now.merged_windows,
            .frames = now.frames,
            .skipped_frames = now.skipped_frames,
            .used_images = impl_->render().used_images(),
            .dropped_images = impl_->render().dropped_images(),
            .latency_p50 = us(now.latency.p50),
            .latency_p99 = us(now.latency.p99)};
}

}  // namespace eventide
