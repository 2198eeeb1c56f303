// One run of the pipeline: everything that was named is opened, connected, run and closed.
#pragma once

#include "apps/cli/command.h"
#include "apps/cli/run/colour.h"
#include "apps/cli/run/data_observers.h"
#include "apps/cli/run/loaded_model.h"
#include "apps/cli/run/outputs_left.h"
#include "apps/cli/run/quality/run_quality.h"
#include "apps/cli/run/reference_images.h"
#include "apps/cli/run/report/run_report.h"
#include "apps/cli/run/run_input.h"
#include "apps/cli/run/run_outputs.h"
#include "apps/cli/run/run_plan.h"
#include "apps/cli/run/start_watch.h"
#include "apps/cli/service_manager.h"
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
    ~Run() { outputs_.close_sinks(); }
    Run(const Run&) = delete;
    Run& operator=(const Run&) = delete;

    /// Returns the exit code. Throws Error.
    int run();

private:
    std::function<bool()> give_up_waiting();
    void open_outputs();
    void end_without_outputs(const std::string& unread, PipeReader why);
    void make_pipeline();
    int report(const RunProgress& end) const;
    RunQuality::Place quality_place() const;
    bool gives_up();
    SinkPlan sink_plan(const OutputOptions& growing);
    ModelRenderStage render_stage();
    PipelineParts parts();
    PipelineSettings pipeline_settings();
    void resume(TensorFile state);
    void keep_state(const PipelineState& memory);
    void keep_last_state();
    void run_pipeline();
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
    OutputsLeft outputs_left_;
    RunInput input_;
    const std::vector<SensorTime> states_at_;
    RunQuality quality_;  // puts into the settings what it chooses
    Network network_;
    const SlicerSettings slicer_;
    const FrameRate rate_;
    const int lookahead_;
    const std::optional<UndistortionPlan> undistortion_;
    const bool sheet_, page_;
    const std::chrono::steady_clock::time_point begun_;
    ReferenceImages references_;
    ImagesOnTheWay images_;
    std::unique_ptr<EventFilters> filter_;
    DataObservers observers_;
    ModelRenderStage render_;
    std::optional<ColourNetworks> colour_;  // none: frames are grey
    LiveChanges changes_;
    std::atomic<std::uint64_t> waits_{0};     // Snapshot::waits
    std::atomic<bool> pipeline_made_{false};  // until then viewers of the page see no counters
    RunOutputs outputs_;                      // a page's threads ask what is above
    std::optional<Pipeline> pipeline_;
};

}  // namespace eventide::app
