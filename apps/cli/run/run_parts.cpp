// What a run hands to the pipeline, to its sinks and to the live page.
#include "apps/cli/printable.h"
#include "apps/cli/run/live_controls.h"
#include "apps/cli/run/report/status.h"
#include "apps/cli/run/run.h"
#include "apps/cli/version.h"
#include "src/core/sensor_limits.h"

#include <nlohmann/json.hpp>

namespace eventide::app {

namespace {

/// Who is given the frames may not look at the page by that: in the record of a run its token is
/// only said to have been given.
constexpr const char* kGiven = "(given)";

bool is_secret(const std::string& http_token) {
    return http_token != "auto" && http_token != "none";
}

std::vector<std::string> without_token(std::vector<std::string> arguments) {
    const std::string flag = "--http-token";
    for (std::size_t i = 0; i < arguments.size(); ++i)
        if (arguments[i].starts_with(flag + "="))
            arguments[i] = flag + "=" + kGiven;
        else if (i > 0 && arguments[i - 1] == flag)
            arguments[i] = kGiven;
    return arguments;
}

}  // namespace

/// Asked while the reader of a pipe, or the end of a viewer's pause, is waited for. Thread: any.
bool Run::gives_up() {
    ++waits_;
    start_.goes_on();
    return program_.signals.stopping();
}

SinkPlan Run::sink_plan(const OutputOptions& growing) {
    SinkPlan plan;
    plan.fps = nominal_fps(rate_, slicer_, settings_.slow);
    plan.rate = video_rate_of(settings_, slicer_);
    plan.constant_rate = rate_.is_set();
    plan.speed = speed_ > 0 ? speed_ : 1;
    plan.sensor = {input_.sensor().width, input_.sensor().height};
    plan.live = input_.live();
    plan.undistortion = undistortion_;
    plan.references = sheet_ ? &references_ : nullptr;
    plan.reference_caption = reference_caption(input_.sensor());
    plan.questions.stopping = growing.give_up;
    plan.questions.unread = growing.unread;
    plan.questions.lost = [this] { return pipeline_->snapshot().lost(); };
    plan.questions.run_json = [this] { return run_json(); };
    if (input_.paced() != nullptr)
        plan.questions.speed_changed = [this](double factor) { input_.paced()->set_speed(factor); };
    plan.questions.snapshot = [this] { return snapshot(); };
    plan.questions.stats = [this](double event_rate) {
        RunProgress now = progress();
        now.event_rate = event_rate;
        return stats_json(snapshot(), now, false);
    };
    if (page_) plan.controls = controls();
    return plan;
}

std::vector<HttpControl> Run::controls() {
    LiveControlsPlan plan{settings_, changes_, {input_.sensor().width, input_.sensor().height}};
    plan.fps = nominal_fps(rate_, slicer_, settings_.slow);
    plan.lookahead = lookahead_;
    plan.speed = speed_;
    if (input_.paced() != nullptr)
        plan.set_speed = [this](double factor) { input_.paced()->set_speed(factor); };
    plan.live = input_.live();
    plan.slicer = slicer_;
    plan.min_window = [this] { return quality_.state().level.min_window; };
    auto controls = live_controls(plan);
    quality_.follow(controls, changes_);
    return controls;
}

ModelRenderStage Run::render_stage() {
    const RenderRequest request = request_of(settings_, input_.sensor(), lookahead_, undistortion_);
    if (settings_.frames == CameraFrames::ignore) return {network_.renderer(), request};
    if (input_.live()) images_.keep_at_most(ImagesOnTheWay::kKeptLive);
    return {network_.renderer(), request, input_.sensor().width, input_.sensor().height, images_};
}

PipelineParts Run::parts() {
    RenderStage& render = colour_ ? colour_->render() : static_cast<RenderStage&>(render_);
    EncodeStage& encode = colour_ ? colour_->encode() : network_.encoder();
    EventFilter* last = filter_.get();
    if (outputs_.events() != nullptr) last = outputs_.events();
    // What is recorded is what came, before any filter.
    Source& came = outputs_.recorded() != nullptr ? *outputs_.recorded() : input_.source();
    PipelineParts parts{input_.behind_filters(came), encode, render, {}, last, &observers_};
    for (const auto& sink : outputs_.sinks()) parts.sinks.push_back(sink.get());
    return parts;
}

PipelineSettings Run::pipeline_settings() {
    PipelineSettings settings;
    settings.bins = network_.config().bins;
    settings.event_windows.slicer = slicer_;
    settings.rate = rate_;
    settings.frames_from = input_.span().frames_from;
    if (settings_.out.empty()) settings.frames_from = from_us(kFarthestUs);  // none
    if (input_.resumed()) settings.resume = &input_.resumed()->stream;
    settings.state_stops = {states_at_,
                            [this](const PipelineState& memory) { keep_state(memory); }};
    settings.lookahead = lookahead_;
    settings.latency = latency_of(settings_, input_.live());
    settings.reset_on_gap = settings_.reset_on_gap;
    settings.allow_silence = settings_.allow_silence;
    settings.event_preview = settings_.events || sheet_ || page_;
    settings.changes = page_ || quality_.changes_while_running() ? &changes_ : nullptr;
    settings.halvings = quality_.halvings();
    settings.events_per_pixel = render_.fused() != nullptr;
    settings.buffers = buffers_for(input_.source());
    if (input_.live()) settings.buffers.latents = 3;
    if (settings_.buffers_packets) {
        const auto packets = std::size_t(*settings_.buffers_packets);
        settings.buffers.packets =
            input_.live() ? packets : std::min(settings.buffers.packets, packets);
    }
    if (settings_.buffers_grids) settings.buffers.grids = std::size_t(*settings_.buffers_grids);
    if (settings_.buffers_latents)
        settings.buffers.latents = std::size_t(*settings_.buffers_latents);
    return settings;
}

/// What was asked, with what, and what came out.
std::string Run::run_json() {
    const RunProgress now = progress();
    nlohmann::ordered_json json;
    json["program"] = "eventide " + version();
    const bool secret = is_secret(settings_.http_token);
    json["arguments"] = secret ? without_token(program_.arguments) : program_.arguments;
    // Not stopped, and nothing failed: all that was asked for is there.
    json["complete"] = pipeline_.has_value() && pipeline_->is_whole();
    json["source"] = {{"name", settings_.source},       {"format", input_.sensor().format},
                      {"sensor", input_.sensor().name}, {"serial", input_.sensor().serial},
                      {"width", input_.sensor().width}, {"height", input_.sensor().height}};
    json["model"] = {{"file", network_.file().string()},
                     {"encoder", encoder_identity(network_.model())},
                     {"engine", network_.encoder().description()},
                     {"card", network_.config().card}};
    json["quality"] = quality_json(quality_.state(), true);
    nlohmann::ordered_json values;
    for (const Setting& setting : settings_.table().settings) {
        const auto texts = setting.show();
        if (setting.kind == ValueKind::list)
            values[setting.key] = texts;
        else
            values[setting.key] = texts.back();
    }
    if (secret) values["http_token"] = kGiven;
    json["settings"] = values;
    json["counters"] = nlohmann::ordered_json::parse(stats_json(counters(), now, true));
    return json_text(json);
}

}  // namespace eventide::app
