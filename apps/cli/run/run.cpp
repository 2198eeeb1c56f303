// One run of the pipeline.
#include "apps/cli/run/run.h"

#include "apps/cli/run/quality/open_settings.h"
#include "apps/cli/run/report/memory_use.h"
#include "apps/cli/run/report/status.h"
#include "apps/cli/run/state/state_folder.h"
#include "drivers/devices.h"
#include "pipeline/demosaiced.h"
#include "pipeline/first_error.h"
#include "src/core/error.h"
#include "src/io/output_file.h"
#include "src/settings/values.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <new>
#include <utility>

namespace eventide::app {

Run::Run(Program& program, RunSettings& settings)
    : program_{program},
      settings_{settings},
      speed_{speed_of(settings)},
      start_{manager_, settings.source},
      readers_{program.files.pipes()},
      outputs_left_{count_outputs(settings)},
      input_{settings, speed_, give_up_waiting()},
      states_at_{state_times_of(settings)},
      quality_{settings, quality_place(), [&program] { return program.signals.stopping(); }},
      network_{settings, input_.sensor()},
      slicer_{slicer_of(settings, network_.config(), input_.span(), input_.as_live())},
      rate_{rate_of(settings, slicer_)},
      lookahead_{lookahead_of(settings, network_.config(), input_.as_live())},
      undistortion_{undistortion_of(settings, input_.sensor())},
      sheet_{std::ranges::any_of(settings.out, is_contact_sheet)},
      page_{std::ranges::any_of(settings.out, is_http)},
      begun_{std::chrono::steady_clock::now()},
      filter_{filter_of(settings, network_.config(), input_.sensor(), !input_.as_live())},
      observers_{sheet_ ? &references_ : nullptr,
                 settings.frames == CameraFrames::ignore ? nullptr : &images_,
                 told_filter(input_.colours(), settings.bayer.has_value())},
      render_{render_stage()} {
    input_.check(program.flags, slicer_);
    quality_.tell_rate(rate_.is_set() ? nominal_fps(rate_, slicer_, settings.slow) : 0);
    if (settings.colour) {
        colour_.emplace(network_, input_.sensor(), input_.colours(),
                        request_of(settings, input_.sensor(), lookahead_, undistortion_),
                        render_.fused() != nullptr ? &images_ : nullptr, network_.encoder(),
                        render_);
        observers_.hand_images_to(*colour_);
    }
    if (auto state = input_.take_state()) resume(std::move(*state));
    if (!settings.states_out.empty()) check_stream_state(settings, "--states-out", input_.live());
    input_.go_to_begin();
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

/// A run that is stopped while its outputs are opened has no pipeline yet.
void Run::end_without_outputs(const std::string& unread, PipeReader why) {
    if (!outputs_left_.go_on_without(unread, why) && pipeline_) pipeline_->stop();
}

void Run::open_outputs() {
    const OutputOptions growing{
        .overwrite = settings_.overwrite,
        .appears = Appears::growing,
        .give_up = [this] { return gives_up(); },
        .unread = [this](const std::string& name,
                         PipeReader why) { end_without_outputs(name, why); }};
    readers_.wait(growing.give_up);
    const auto from = [this] {
        return pipeline_->clock_began_anew() ? std::nullopt : input_.span().frames_from;
    };
    const auto to = [this] { return pipeline_->end(); };
    outputs_.open(settings_, input_, sink_plan(growing), {filter_.get(), from, to}, growing);
    observers_.hand_all_to(outputs_.events());
    readers_.let_go();
}

void Run::make_pipeline() {
    try {
        pipeline_.emplace(parts(), pipeline_settings());
        pipeline_made_ = true;
    } catch (const std::bad_alloc&) {
        const auto& config = network_.config();
        const RenderRequest request =
            request_of(settings_, input_.sensor(), lookahead_, undistortion_);
        throw out_of_memory(
            "the network with its buffers (--buffers-grids, --buffers-latents) and "
            "a frame of " +
                show_size({request.width, request.height}) + " (--size, --roi)",
            network_bytes(config, input_.sensor(), settings_.precision) +
                frame_bytes(request, input_.sensor()) +
                buffer_bytes(config, input_.sensor(), pipeline_settings().buffers,
                             settings_.precision),
            input_.sensor());
    }
}

RunQuality::Place Run::quality_place() const {
    const double pace = input_.pace();
    if (settings_.realtime && pace <= 0)
        throw Error(ErrorKind::usage, "--realtime: expected a camera or a recording, found " +
                                          settings_.source + ", which comes as fast as possible");
    return {input_.sensor(), input_.span(), input_.as_live(), pace,
            chooses_quality(settings_, input_.live(), pace)};
}

Snapshot Run::counters() const {
    Snapshot now = pipeline_->snapshot();
    input_.count(now);
    now.waits = waits_;
    now.used_images = render_.used_images();
    now.dropped_images = render_.dropped_images();
    return now;
}

RunProgress Run::progress() const {
    RunProgress progress;
    progress.elapsed = std::chrono::steady_clock::now() - begun_;
    progress.in_step = input_.live() || speed_ > 0;
    progress.total_bytes = input_.bytes_to_read();
    progress.end = input_.span().end;
    progress.duration = input_.span().duration;
    progress.quality = quality_.state();
    return progress;
}

int Run::run() {
    const Stopper stopper{program_.signals, [this] { pipeline_->stop(); }};
    const auto quality = [this](const Snapshot& now, std::chrono::duration<double> elapsed) {
        quality_.look(now, elapsed, input_.pace(), changes_);
        return quality_.state();
    };
    start_.end();
    Status status{[this] { return counters(); },
                  progress(),
                  outputs_.take_stats(),
                  program_.quiet,
                  input_.live(),
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
    outputs_.finish(error);
    error.rethrow_if_any();
}

}  // namespace eventide::app
