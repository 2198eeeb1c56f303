// See run_outputs.h.
#include "apps/cli/run/run_outputs.h"

#include "apps/cli/printable.h"

#include <spdlog/spdlog.h>

#include <string>
#include <utility>

namespace eventide::app {

namespace {

std::unique_ptr<RecordedSource> recorder_of(const RunSettings& settings, RunInput& input,
                                            const OutputOptions& growing) {
    if (settings.record.empty()) return nullptr;
    return std::make_unique<RecordedSource>(input.source(), settings.record, input.source_colours(),
                                            growing);
}

std::unique_ptr<EventsOut> events_out_of(const RunSettings& settings, const RunInput& input,
                                         RunOutputs::EventsPlan plan,
                                         const OutputOptions& growing) {
    if (settings.events_out.empty()) return nullptr;
    StreamHeader header;
    header.width = input.sensor().width;
    header.height = input.sensor().height;
    header.sensor_name = input.sensor().name;
    header.serial = input.sensor().serial;
    header.colour_filter = input.colours();
    return std::make_unique<EventsOut>(plan.filter,
                                       open_event_target(settings.events_out, growing, header),
                                       std::move(plan.from), std::move(plan.to), input.colours());
}

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

void RunOutputs::open(const RunSettings& settings, RunInput& input, const SinkPlan& plan,
                      EventsPlan events, const OutputOptions& growing) {
    sinks_ = open_sinks(settings, plan);
    // Behind them: other files may lie in a folder that a sink makes.
    recorded_ = recorder_of(settings, input, growing);
    events_ = events_out_of(settings, input, std::move(events), growing);
    if (!settings.states_out.empty()) states_.emplace(settings.states_out, settings.overwrite);
    stats_ = stats_of(settings, growing);
}

void RunOutputs::finish(FirstError& error) {
    error.guard([&] {
        if (recorded_) recorded_->finish();
    });
    error.guard([&] {
        if (events_) events_->finish();
    });
}

bool RunOutputs::is_all_written(const RunSettings& settings) const {
    bool all = true;
    const auto say = [&](const std::string& file, const WrittenData& data) {
        for (const std::string& remark : data.remarks(file)) spdlog::warn("{}", remark);
        all = all && data.is_whole();
    };
    if (recorded_) say(settings.record, recorded_->data());
    if (events_) say(settings.events_out, events_->data());
    return all;
}

}  // namespace eventide::app
