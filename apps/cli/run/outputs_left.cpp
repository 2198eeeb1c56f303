// Outputs for which a run goes on.
#include "apps/cli/run/outputs_left.h"

#include "apps/cli/printable.h"
#include "apps/cli/settings/sink_name.h"

#include <spdlog/spdlog.h>

namespace eventide::app {

std::size_t count_outputs(const RunSettings& settings) {
    std::size_t count =
        std::size_t(!settings.record.empty()) + std::size_t(!settings.events_out.empty());
    for (const std::string& out : settings.out) {
        const SinkKind kind = parse_sink(out).kind;
        if (kind != SinkKind::nothing) ++count;
        if (kind == SinkKind::video && settings.uncertainty == Uncertainty::separate) ++count;
    }
    return count;
}

bool OutputsLeft::go_on_without(const std::string& name, PipeReader why) {
    // The others are given up only when the run is to end.
    const bool ends = --left_ <= 0 || why != PipeReader::left;
    const bool is_expected = ends && why == PipeReader::left;
    spdlog::log(is_expected ? spdlog::level::info : spdlog::level::warn, "{}: {}{}",
                printable(name), text_of(why),
                ends ? "" : "; the run goes on for the other outputs");
    return !ends;
}

}  // namespace eventide::app
