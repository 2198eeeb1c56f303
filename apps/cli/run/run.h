// One run of the pipeline: everything that was named is opened, connected, run and closed.
#pragma once

#include "apps/cli/command.h"
#include "apps/cli/run/colour.h"
#include "apps/cli/run/data_observers.h"
#include "apps/cli/run/events_out.h"
#include "apps/cli/run/loaded_model.h"
#include "apps/cli/run/open_outputs.h"
#include "apps/cli/run/open_sinks.h"
#include "apps/cli/run/open_source.h"
#include "apps/cli/run/quality/run_quality.h"
#include "apps/cli/run/recorded_source.h"
#include "apps/cli/run/reference_images.h"
#include "apps/cli/run/report/run_report.h"
#include "apps/cli/run/run_plan.h"
#include "apps/cli/run/start_watch.h"
#include "apps/cli/run/state/state_folder.h"
#include "apps/cli/run/state/stream_state.h"
#include "apps/cli/service_manager.h"
#include "pipeline/filters/filter_chain.h"
#include "pipeline/model_render_stage.h"
#include "pipeline/pipeline.h"
#include "src/io/held_pipes.h"

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace eventide::app {

/// Inputs are opened before outputs, so that a wrong input leaves nothing behind.
class Run {
public:
    /// Throws Error.
    Run(Program& program, RunSettings& settings);
    /// Sinks end first: viewers of the live page ask for counters until then.
    ~Run() { sinks_.clear(); }
    Run(const Run&) = delete;
    Run& operator=(const Run&) = delete;

    /// Returns the exit code. Throws Error.
    int run();

private:
    std::function<bool()> give_up_waiting();
    void go_to_begin();
    void open_outputs();
    void end_without_outputs(const std::string& unread, PipeReader why);
    void make_pipeline();
    int report(const RunProgress& end) const;
    Source& source();
    bool live() const { return opened_.source->is_live(); }
    /// A camera, or a recording as if a camera gave it.
    bool as_live() const { return live() || settings_.realtime; }
    double pace() const;
    RunQuality::Place quality_place() const;
    bool gives_up();
    SinkPlan sink_plan(const OutputOptions& growing);
    ModelRenderStage render_stage();
    PipelineParts parts();
    PipelineSettings pipeline_settings();
    void resume();
    void keep_state(const PipelineState& memory);
    void keep_last_state();
    void run_pipeline();
    bool wrote_all_data() const;
    RunProgress progress() const;
    std::string run_json();
    std::vector<HttpControl> controls();
    /// The pipeline's, and those of all around it. What the filters left out counts as read.
    Snapshot counters() const;
    Snapshot snapshot() const { return pipeline_made_ ? counters() : Snapshot{}; }

    Program& program_;
    RunSettings& settings_;
    ServiceManager manager_;
    const double speed_;
    StartWatch start_;   // until run()
    HeldPipes readers_;  // of outputs, until those are open
    OpenOutputs outputs_;
    OpenedSource opened_;
    FilterChain filters_;
    const SensorInfo sensor_;
    std::optional<TensorFile> state_;     // none: not asked for, or restored
    std::optional<StreamState> resumed_;  // none: the stream begins anew
    const std::vector<SensorTime> states_at_;
    const Span span_;
    RunQuality quality_;  // puts into the settings what it chooses
    Network network_;
    const SlicerSettings slicer_;
    const FrameRate rate_;
    const int lookahead_;
    const std::optional<UndistortionPlan> undistortion_;
    const ColourFilter source_colours_;  // before all filters, ...
    const ColourFilter colour_filter_;   // ... and behind them
    const bool sheet_, page_;
    const std::chrono::steady_clock::time_point begun_;
    std::uint64_t bytes_to_read_ = 0;  // of a recording; 0: not known
    bool is_stream_ = true;            // what is read are the recording's own bytes
    ReferenceImages references_;
    ImagesOnTheWay images_;
    std::unique_ptr<RecordedSource> recorded_;  // null: nothing is recorded
    std::unique_ptr<OutputFile> stats_;         // null: not asked for, or taken by run()
    std::unique_ptr<EventFilters> filter_;
    std::optional<FilteredSource> filtered_;  // none: without --filter
    std::unique_ptr<EventsOut> events_out_;   // null: not asked for
    DataObservers observers_;
    ModelRenderStage render_;
    std::optional<ColourNetworks> colour_;  // none: frames are grey
    LiveChanges changes_;
    std::atomic<bool> pipeline_made_{false};  // until then viewers of the page see no counters
    std::optional<Pipeline> pipeline_;
    std::optional<StateFolder> states_;         // none: not asked for
    std::atomic<std::uint64_t> waits_{0};       // Snapshot::waits
    std::vector<std::unique_ptr<Sink>> sinks_;  // last: a page's threads ask the others
};

}  // namespace eventide::app
