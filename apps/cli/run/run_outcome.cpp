// What a run says at its end.
#include "apps/cli/commands/disorder.h"
#include "apps/cli/run/report/run_report.h"
#include "apps/cli/run/run.h"
#include "pipeline/filters/event_filter.h"
#include "src/core/error.h"

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
    const CameraCounters camera = camera_counters();
    spdlog::info("{}{}", summary_text(end_counters, end), camera_text(camera));
    if (!filters_.empty()) spdlog::info("filters left out: {}", filters_.report());
    if (const std::string remark = flicker_remark(end_counters.flicker); !remark.empty())
        spdlog::info("{}", remark);
    if (const std::string why = disorder_text(settings_.source, sensor_.format, end_counters.events,
                                              end_counters.damaged);
        !why.empty())
        spdlog::warn("{}", why);
    if (states_ < states_at_.size() && !program_.signals.stopping())
        throw Error(ErrorKind::input, "--states-at: expected " + std::to_string(states_at_.size()) +
                                          " times before the last event, found " +
                                          std::to_string(states_));
    if (const std::string why = why_no_frames(end_counters);
        !why.empty() && !program_.signals.stopping() && !settings_.out.empty())
        spdlog::warn("{}", why);
    if (end_counters.used_images > 0)
        spdlog::info("frames corrected by {} of the camera's images{}", end_counters.used_images,
                     dropped_text(end_counters.dropped_images));
    else if (settings_.frames == CameraFrames::use)
        spdlog::warn("--frames use: no image of the camera could be used, of {} in the stream",
                     end_counters.images);
    const std::uint64_t unsent = events_out_ ? events_out_->lost() : 0;
    if (unsent > 0) spdlog::warn("{}: lost {}", settings_.events_out, lost_datagrams(unsent));
    const std::uint64_t late_triggers = say_what_was_moved();
    const bool lost =
        lost_data(end_counters) || camera.device_dropped > 0 || unsent > 0 || late_triggers > 0;
    return settings_.strict && lost ? exit_data_lost : exit_done;
}

/// Of the files of data that the run wrote. Returns how many triggers are not at their own time.
std::uint64_t Run::say_what_was_moved() const {
    std::uint64_t late = 0;
    const auto say = [&](const std::string& file, const WrittenTimes* times) {
        if (times == nullptr) return;
        for (const std::string& remark : times->remarks(file)) spdlog::warn("{}", remark);
        late += times->late_triggers();
    };
    if (recorded_) say(settings_.record, recorded_->times());
    if (events_out_) say(settings_.events_out, &events_out_->times());
    return late;
}

CameraCounters Run::camera_counters() const {
    const auto* camera = dynamic_cast<const Camera*>(opened_.source.get());
    return camera == nullptr ? CameraCounters{} : camera->counters();
}

}  // namespace eventide::app
