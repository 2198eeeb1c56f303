// One run of the whole pipeline over a made stream.
#include "apps/cli/stress/pipeline_run.h"

#include "pipeline/filters/event_filter.h"
#include "src/binning/slicer_settings.h"
#include "src/core/error.h"
#include "src/model/encode/encoder.h"
#include "src/model/render/renderer.h"

#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <utility>

namespace eventide::stress {
namespace {

class FrameWatch final : public Sink {
public:
    explicit FrameWatch(const PipelineRunSettings& settings) : settings_{settings} {}

    void write(const Frame& frame) override {
        if (!first_) first_ = frame.t;
        mix(std::uint64_t((frame.t - *first_).count()));
        for (const Array2<float>* map : {&frame.intensity, &frame.sigma})
            for (const float value : map->values()) mix(std::bit_cast<std::uint32_t>(value));
        last_ = frame;
        if (settings_.on_frame) settings_.on_frame(frame);
    }
    bool wants_more() const override { return !settings_.stopping || !settings_.stopping(); }
    std::uint64_t bits() const { return bits_; }
    Frame take_last() { return std::move(last_); }

private:
    /// FNV-1a, a word at a time.
    void mix(std::uint64_t word) { bits_ = (bits_ ^ word) * 0x100000001b3ULL; }

    const PipelineRunSettings& settings_;
    std::optional<SensorTime> first_;
    std::uint64_t bits_ = 0xcbf29ce484222325ULL;
    Frame last_;
};

/// Lets whoever asked for it change grids on their way.
class GridHook final : public EncodeStage {
public:
    GridHook(EncodeStage& stage, const std::function<void(VoxelGrid&)>& hook)
        : stage_{stage}, hook_{hook} {}
    LatentMap make_output() const override { return stage_.make_output(); }
    void reset() noexcept override { stage_.reset(); }

private:
    void step(const VoxelGrid& grid, LatentMap& latent) noexcept override {
        VoxelGrid changed = grid;
        hook_(changed);
        stage_.encode(changed, latent);
    }

    EncodeStage& stage_;
    const std::function<void(VoxelGrid&)>& hook_;
};

PipelineSettings pipeline_settings(const Model& model, const PipelineRunSettings& settings) {
    PipelineSettings how;
    how.bins = model.config.bins;
    how.event_windows.slicer = parse_window(settings.window);
    if (settings.fps != "frame") how.rate = parse_frame_rate(settings.fps);
    how.lookahead = settings.lookahead;
    how.buffers = run_buffers(settings.threaded);
    how.allow_silence = true;
    return how;
}

}  // namespace

PipelineBuffers run_buffers(bool threaded) {
    return threaded ? PipelineBuffers{4, 2, 3} : PipelineBuffers{4, 1, 1};
}

PipelineOutcome run_pipeline(const Model& model, Source& source,
                             const PipelineRunSettings& settings) {
    Encoder encoder{model, settings.width, settings.height, settings.engine};
    Renderer renderer{model, settings.width, settings.height, settings.engine};
    if (settings.state) encoder.restore(*settings.state, "state");
    std::optional<Judge> judge;
    if (settings.sampling)
        judge.emplace(model, settings.width, settings.height, *settings.sampling);
    Judge* const judged = judge ? &*judge : nullptr;
    RenderRequest request;
    request.width = settings.size.width;
    request.height = settings.size.height;
    request.region = settings.size.region;
    request.lookahead = settings.lookahead;
    JudgedEncodeStage encode{encoder, judged};
    GridHook hooked{encode, settings.on_grid};
    JudgedRenderStage render{renderer, request, judged};
    FrameWatch watch{settings};
    EncodeStage& first = settings.on_grid ? static_cast<EncodeStage&>(hooked) : encode;
    const auto filter =
        event_filter({"off", "model"}, model.config, settings.width, settings.height);
    Pipeline pipeline{{source, first, render, {&watch}, filter.get()},
                      pipeline_settings(model, settings)};
    PipelineOutcome outcome;
    try {
        settings.threaded ? pipeline.run() : pipeline.run_sequential();
    } catch (const Error& error) {
        outcome.error = error.what();
    }
    outcome.counters = pipeline.snapshot();
    outcome.state = encoder.state();
    if (judge) {
        outcome.codes = judge->codes();
        outcome.frames = judge->frames();
        judge->note_state(outcome.state);
        outcome.largest_state = judge->largest_state();
    }
    outcome.bits = watch.bits();
    outcome.last = watch.take_last();
    outcome.engine = encoder.description();
    return outcome;
}

PipelineOutcome run_pipeline(const Model& model, MakeEvents events,
                             const PipelineRunSettings& settings) {
    MadeStream source{settings.width, settings.height, std::move(events)};
    return run_pipeline(model, source, settings);
}

std::string short_number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", value);
    return text;
}

std::string counted(std::uint64_t n, std::string_view what) {
    std::string digits = std::to_string(n);
    for (std::ptrdiff_t at = std::ptrdiff_t(digits.size()) - 3; at > 0; at -= 3)
        digits.insert(std::size_t(at), ",");
    return digits + " " + std::string{what};
}

}  // namespace eventide::stress
