// What a run says at its end.
#include "apps/cli/run/report/run_report.h"
#include "apps/cli/run/run.h"
#include "pipeline/filters/event_filter.h"
#include "replay/left_out.h"
#include "src/core/error.h"
#include "src/core/number_text.h"

#include <spdlog/spdlog.h>

#include <string>

namespace eventide::app {

namespace {

std::string dropped_text(std::uint64_t images) {
    return images == 0 ? "" : "; " + std::to_string(images) + " came too late or were too many";
}

}  // namespace

/// Says what came out. Returns the exit code.
int Run::report(const RunProgress& end) const {
    const Snapshot end_counters = counters();
    spdlog::info("{}", summary_text(end_counters, end));
    if (!input_.filters().empty()) spdlog::info("filters left out: {}", input_.filters().report());
    if (const std::string remark = flicker_remark(end_counters.flicker); !remark.empty())
        spdlog::info("{}", remark);
    if (const std::string why = left_out_text(settings_.source, input_.sensor().format,
                                              end_counters.events, end_counters.damaged);
        !why.empty())
        spdlog::warn("{}", why);
    const StateFolder* const states = outputs_.states();
    if (states != nullptr && states->kept() < states_at_.size() && !program_.signals.stopping())
        throw Error(ErrorKind::usage, "--states-at " + settings_.states_at[states->kept()] +
                                          ": expected a time before the run's last event, found "
                                          "one after it; wrote " +
                                          counted(states->kept(), "state"));
    if (const std::string why = why_no_frames(end_counters);
        !why.empty() && !program_.signals.stopping() && !settings_.out.empty())
        spdlog::warn("{}", why);
    if (end_counters.used_images > 0)
        spdlog::info("frames corrected by {} of the camera's images{}", end_counters.used_images,
                     dropped_text(end_counters.dropped_images));
    else if (settings_.frames == CameraFrames::use)
        spdlog::warn("--frames use: no image of the camera could be used, of {} in the stream",
                     end_counters.images);
    const std::uint64_t unsent = outputs_.lost_datagrams();
    if (unsent > 0) spdlog::warn("{}: lost {}", settings_.events_out, lost_datagrams(unsent));
    const bool all_written = outputs_.is_all_written(settings_);
    const bool lost = lost_data(end_counters) || unsent > 0 || !all_written;
    return settings_.strict && lost ? exit_data_lost : exit_done;
}

}  // namespace eventide::app
