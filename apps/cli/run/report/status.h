// While a run goes on: the moving line on a terminal, the JSON lines of --stats, and what a service
// manager wants to know.
#pragma once

#include "apps/cli/run/report/run_report.h"
#include "apps/cli/run/report/status_line.h"
#include "apps/cli/service_manager.h"
#include "apps/cli/terminal.h"
#include "src/io/output_file.h"

#include <condition_variable>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

namespace eventide::app {

class Status {
public:
    /// `snapshot` may be called from any thread. `stats` may be null; it shows under its name with
    /// its first line and grows from then on. `live`: of a camera, which works in silence, too.
    /// `quality` is asked on the thread of the line, 4 times a second, and may change it. `manager`
    /// is borrowed.
    using Quality =
        std::function<QualityState(const Snapshot&, std::chrono::duration<double> elapsed)>;
    Status(std::function<Snapshot()> snapshot, RunProgress fixed, std::unique_ptr<OutputFile> stats,
           bool quiet, bool live, ServiceManager& manager, Quality quality = {});
    ~Status();
    Status(const Status&) = delete;
    Status& operator=(const Status&) = delete;

    /// Ends the line and writes the last JSON line. Once, after the run. Throws Error (failed)
    /// where a line could not be written.
    RunProgress finish();

private:
    void tick();
    RunProgress progress(const Snapshot& now);
    void write_stats(const Snapshot& now, bool final);
    // Each says it once.
    void note_flicker(const FlickerFound& flicker);
    void note_image_clock(SensorDuration apart);
    void tell_manager(const Snapshot& now, const RunProgress& state, bool also_status);

    std::function<Snapshot()> snapshot_;
    const Quality quality_;
    RunProgress fixed_;
    std::unique_ptr<OutputFile> stats_;  // null: not asked for, or it failed
    std::exception_ptr stats_failure_;
    const bool live_;
    ProgressLine line_;
    ServiceManager& manager_;
    bool flicker_said_ = false, image_clock_said_ = false;
    std::uint64_t last_work_ = 0;  // packets, event windows and frames when the manager was told
    std::chrono::steady_clock::time_point begun_;
    std::uint64_t last_events_ = 0;
    std::chrono::duration<double> last_elapsed_{0};
    double event_rate_ = 0;

    std::mutex mutex_;
    std::condition_variable ended_;
    bool end_ = false;
    std::jthread thread_;
};

}  // namespace eventide::app
