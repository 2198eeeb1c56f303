// One run of the pipeline.
#include "apps/cli/run/run.h"

#include "apps/cli/commands/look_ahead.h"
#include "apps/cli/printable.h"
#include "apps/cli/run/quality/open_settings.h"
#include "apps/cli/run/report/memory_use.h"
#include "apps/cli/run/report/status.h"
#include "apps/cli/run/state/state_folder.h"
#include "drivers/devices.h"
#include "pipeline/demosaiced.h"
#include "pipeline/first_error.h"
#include "replay/formats.h"
#include "src/core/error.h"
#include "src/io/output_file.h"
#include "src/settings/values.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>
#include <new>
#include <utility>

namespace eventide::app {

namespace {

std::unique_ptr<RecordedSource> recorder_of(const RunSettings& settings, Source& source,
                                            ColourFilter colours, const OutputOptions& growing) {
    if (settings.record.empty()) return nullptr;
    return std::make_unique<RecordedSource>(source, settings.record, colours, growing);
}

SensorPixels size_of(const Source& source) {
    return {source.info().width, source.info().height};
}

/// Null: not asked for.
std::unique_ptr<EventsOut> events_out_of(const RunSettings& settings, const SensorInfo& sensor,
                                         ColourFilter colours, EventsOut::Limit from,
                                         EventsOut::Limit to, EventFilter* filter,
                                         const OutputOptions& growing) {
    if (settings.events_out.empty()) return nullptr;
    StreamHeader header;
    header.width = sensor.width;
    header.height = sensor.height;
    header.sensor_name = sensor.name;
    header.serial = sensor.serial;
    header.colour_filter = colours;
    return std::make_unique<EventsOut>(filter,
                                       open_event_target(settings.events_out, growing, header),
                                       std::move(from), std::move(to), colours);
}

std::optional<TensorFile> state_in_of(const RunSettings& settings) {
    if (settings.state_in.empty()) return std::nullopt;
    return read_safetensors(settings.state_in);
}

std::optional<StreamState> stream_in(const RunSettings& settings, std::optional<TensorFile>& state,
                                     const SensorInfo& sensor, bool live) {
    if (!state) return std::nullopt;
    auto stream = take_stream_state(*state, settings.state_in, sensor.width, sensor.height);
    if (stream) check_stream_state(settings, "--state-in " + settings.state_in, live);
    return stream;
}

Span span_in(const RunSettings& settings, const std::optional<StreamState>& resumed, bool live) {
    const Span span = span_of(settings, live);
    return resumed ? resumed_span(settings, span, resumed->stream.t) : span;
}

/// Null: not asked for.
std::unique_ptr<OutputFile> stats_of(const RunSettings& settings, OutputOptions options) {
    if (settings.stats.empty()) return nullptr;
    options.appears = Appears::whole;
    // The run is worth more than its counters.
    options.unread = [](const std::string& name, PipeReader why) {
        spdlog::warn("--stats {}: {}", printable(name), text_of(why));
    };
    return std::make_unique<OutputFile>(settings.stats == "-" ? "/dev/stderr" : settings.stats,
                                        std::move(options));
}

}  // namespace

Run::Run(Program& program, RunSettings& settings)
    : program_{program},
      settings_{settings},
      speed_{speed_of(settings)},
      start_{manager_, settings.source},
      readers_{program.files.pipes()},
      outputs_{count_outputs(settings)},
      opened_{open_source(settings, speed_, give_up_waiting())},
      filters_{settings.filter, size_of(*opened_.source)},
      sensor_{filters_.behind(opened_.source->info())},
      state_{state_in_of(settings)},
      resumed_{stream_in(settings, state_, sensor_, live())},
      states_at_{state_times_of(settings)},
      span_{span_in(settings, resumed_, live())},
      quality_{settings, quality_place(), [&program] { return program.signals.stopping(); }},
      network_{settings, sensor_},
      slicer_{slicer_of(settings, network_.config(), span_, as_live())},
      rate_{rate_of(settings, slicer_)},
      lookahead_{lookahead_of(settings, network_.config(), as_live())},
      undistortion_{undistortion_of(settings, sensor_)},
      source_colours_{source_colours_of(settings, opened_.source->info(), live())},
      colour_filter_{colour_filter_of(settings, source_colours_, sensor_, filters_)},
      sheet_{std::ranges::any_of(settings.out, is_contact_sheet)},
      page_{std::ranges::any_of(settings.out, is_http)},
      begun_{std::chrono::steady_clock::now()},
      filter_{filter_of(settings, network_.config(), sensor_, !as_live())},
      observers_{sheet_ ? &references_ : nullptr,
                 settings.frames == CameraFrames::ignore ? nullptr : &images_,
                 told_filter(colour_filter_, settings.bayer.has_value())},
      render_{render_stage()} {
    if (opened_.recording != nullptr)
        refuse_idle_input_flags(program.flags, {opened_.recording->info().format});
    const AskedPart part{settings.source, settings.input.options(), settings.from,
                         span_.frames_from, span_.end};
    check_part(part);
    check_images(part, slicer_);
    quality_.tell_rate(rate_.is_set() ? nominal_fps(rate_, slicer_, settings.slow) : 0);
    if (settings.colour) {
        colour_.emplace(network_, sensor_, colour_filter_,
                        request_of(settings, sensor_, lookahead_, undistortion_),
                        render_.fused() != nullptr ? &images_ : nullptr, network_.encoder(),
                        render_);
        observers_.hand_images_to(*colour_);
    }
    if (state_) resume();
    if (!settings.states_out.empty()) check_stream_state(settings, "--states-out", live());
    go_to_begin();
    open_outputs();
    make_pipeline();
}

/// Asked while the source is waited for. What waits for a limited time has not started before it
/// is there.
std::function<bool()> Run::give_up_waiting() {
    const bool has_limit = names_camera(settings_.source) && !settings_.reconnect;
    return [this, has_limit] {
        if (!has_limit) start_.source_is_waited_for();
        readers_.look();
        return program_.signals.stopping();
    };
}

/// Of a recording: where the asked span begins.
void Run::go_to_begin() {
    Recording* const recording = opened_.recording;
    if (recording == nullptr) return;
    if (span_.begin) {
        if (!filters_.empty())
            if (const auto first = first_event_of(settings_, live())) filters_.count_from(*first);
        recording->seek(*span_.begin);
    }
    if (recording->size_bytes() > 0)
        bytes_to_read_ = recording->size_bytes() - recording->position_bytes();
    const Format* const format = find_format(recording->info().format);
    is_stream_ = format == nullptr || format->open_path == nullptr;
}

/// A run that is stopped while its outputs are opened has no pipeline yet.
void Run::end_without_outputs(const std::string& unread, PipeReader why) {
    if (!outputs_.go_on_without(unread, why) && pipeline_) pipeline_->stop();
}

void Run::open_outputs() {
    const OutputOptions growing{
        .overwrite = settings_.overwrite,
        .appears = Appears::growing,
        .give_up = [this] { return gives_up(); },
        .unread = [this](const std::string& name,
                         PipeReader why) { end_without_outputs(name, why); }};
    readers_.wait(growing.give_up);
    sinks_ = open_sinks(settings_, sink_plan(growing));
    // Behind them: other files may lie in a folder that a sink makes.
    recorded_ = recorder_of(settings_, *opened_.source, source_colours_, growing);
    const auto from = [this] {
        return pipeline_->clock_began_anew() ? std::nullopt : span_.frames_from;
    };
    events_out_ = events_out_of(
        settings_, sensor_, colour_filter_, from, [this] { return pipeline_->end(); },
        filter_.get(), growing);
    observers_.hand_all_to(events_out_.get());
    if (!settings_.states_out.empty()) states_.emplace(settings_.states_out, settings_.overwrite);
    stats_ = stats_of(settings_, growing);
    readers_.let_go();
}

void Run::make_pipeline() {
    try {
        pipeline_.emplace(parts(), pipeline_settings());
        pipeline_made_ = true;
    } catch (const std::bad_alloc&) {
        const auto& config = network_.config();
        const RenderRequest request = request_of(settings_, sensor_, lookahead_, undistortion_);
        throw out_of_memory(
            "the network with its buffers (--buffers-grids, --buffers-latents) and "
            "a frame of " +
                show_size({request.width, request.height}) + " (--size, --roi)",
            network_bytes(config, sensor_, settings_.precision) + frame_bytes(request, sensor_) +
                buffer_bytes(config, sensor_, pipeline_settings().buffers, settings_.precision),
            sensor_);
    }
}

/// Sensor time over that of the clock: of a camera, and of a recording that is paced; else 0.
double Run::pace() const {
    if (live()) return 1;
    return opened_.paced != nullptr ? opened_.paced->speed() : 0;
}

RunQuality::Place Run::quality_place() const {
    if (settings_.realtime && pace() <= 0)
        throw Error(ErrorKind::usage, "--realtime: expected a camera or a recording, found " +
                                          settings_.source + ", which comes as fast as possible");
    return {sensor_, span_, as_live(), pace(), chooses_quality(settings_, live(), pace())};
}

/// What is recorded is what came, before any filter.
Source& Run::source() {
    Source& source = recorded_ ? static_cast<Source&>(*recorded_) : *opened_.source;
    if (filters_.empty()) return source;
    if (!filtered_) filtered_.emplace(source, filters_);
    return *filtered_;
}

Snapshot Run::counters() const {
    Snapshot now = pipeline_->snapshot();
    if (const auto* camera = dynamic_cast<const Camera*>(opened_.source.get()))
        now.camera = camera->counters();
    now.events += filters_.left_out();
    now.filtered_events += filters_.left_out();
    now.waits = waits_;
    if (!is_stream_)
        now.parsed_bytes =
            opened_.recording->position_bytes() + bytes_to_read_ - opened_.recording->size_bytes();
    now.used_images = render_.used_images();
    now.dropped_images = render_.dropped_images();
    return now;
}

RunProgress Run::progress() const {
    RunProgress progress;
    progress.elapsed = std::chrono::steady_clock::now() - begun_;
    progress.in_step = live() || speed_ > 0;
    progress.total_bytes = bytes_to_read_;
    progress.end = span_.end;
    progress.duration = span_.duration;
    progress.quality = quality_.state();
    return progress;
}

int Run::run() {
    const Stopper stopper{program_.signals, [this] { pipeline_->stop(); }};
    const auto quality = [this](const Snapshot& now, std::chrono::duration<double> elapsed) {
        quality_.look(now, elapsed, pace(), changes_);
        return quality_.state();
    };
    start_.end();
    Status status{[this] { return counters(); },
                  progress(),
                  std::move(stats_),
                  program_.quiet,
                  live(),
                  manager_,
                  quality};
    run_pipeline();
    if (!settings_.state_out.empty()) keep_last_state();
    return report(status.finish());
}

/// Also when it fails, what has arrived by then is a whole recording; so is one of two files when
/// the other fails.
void Run::run_pipeline() {
    FirstError error;
    error.guard([&] { settings_.sequential ? pipeline_->run_sequential() : pipeline_->run(); });
    error.guard([&] {
        if (recorded_) recorded_->finish();
    });
    error.guard([&] {
        if (events_out_) events_out_->finish();
    });
    error.rethrow_if_any();
}

}  // namespace eventide::app
