// What a run writes: frames, what is recorded, events, states and counters.
#pragma once

#include "apps/cli/run/events_out.h"
#include "apps/cli/run/open_sinks.h"
#include "apps/cli/run/recorded_source.h"
#include "apps/cli/run/run_input.h"
#include "apps/cli/run/state/state_folder.h"
#include "apps/cli/settings/run_settings.h"
#include "pipeline/first_error.h"

#include <memory>
#include <optional>
#include <vector>

namespace eventide::app {

/// Each is null where it was not asked for.
class RunOutputs {
public:
    /// What --events-out is told of events.
    struct EventsPlan {
        EventFilter* filter = nullptr;  ///< borrowed; null: none
        EventsOut::Limit from, to;
    };
    /// Opens all of them, in the order in which name_run_files() names them. `settings` and
    /// `input` are borrowed; `growing` is how files are opened. Throws Error.
    void open(const RunSettings& settings, RunInput& input, const SinkPlan& plan, EventsPlan events,
              const OutputOptions& growing);

    const std::vector<std::unique_ptr<Sink>>& sinks() const { return sinks_; }
    /// Those of frames, whose viewers ask for counters until then.
    void close_sinks() { sinks_.clear(); }
    RecordedSource* recorded() { return recorded_.get(); }
    EventsOut* events() { return events_.get(); }
    StateFolder* states() { return states_ ? &*states_ : nullptr; }
    const StateFolder* states() const { return states_ ? &*states_ : nullptr; }
    /// Once.
    std::unique_ptr<OutputFile> take_stats() { return std::move(stats_); }

    /// After the run: ends what is recorded, and the events. So each is whole when another fails.
    void finish(FirstError& error);
    /// Then: says what the files of data lack. Whether all that they were to hold is in them.
    bool is_all_written(const RunSettings& settings) const;
    /// Datagrams of events that nobody received.
    std::uint64_t lost_datagrams() const { return events_ ? events_->lost() : 0; }

private:
    std::unique_ptr<RecordedSource> recorded_;
    std::unique_ptr<OutputFile> stats_;
    std::unique_ptr<EventsOut> events_;
    std::optional<StateFolder> states_;
    std::vector<std::unique_ptr<Sink>> sinks_;
};

}  // namespace eventide::app
