// While a run goes on: the moving line on a terminal, and the JSON lines of --stats.
#include "apps/cli/run/status.h"

#include <utility>

namespace eventide::app {

using Clock = std::chrono::steady_clock;

namespace {

constexpr std::chrono::milliseconds kTick{250};
constexpr int kTicksPerStats = 4;  // one line of JSON a second

}  // namespace

Status::Status(std::function<Snapshot()> snapshot, RunProgress fixed,
               std::unique_ptr<OutputFile> stats, bool quiet)
    : snapshot_{std::move(snapshot)},
      fixed_{fixed},
      stats_{std::move(stats)},
      line_{quiet},
      begun_{Clock::now()} {
    thread_ = std::jthread{[this] { tick(); }};
}

Status::~Status() {
    {
        const std::lock_guard lock{mutex_};
        end_ = true;
    }
    ended_.notify_all();
}

void Status::tick() {
    for (int n = 1;; ++n) {
        std::unique_lock lock{mutex_};
        if (ended_.wait_for(lock, kTick, [this] { return end_; })) return;
        const Snapshot now = snapshot_();
        const RunProgress state = progress(now);
        line_.show(status_line(now, state, line_.columns()));
        if (n % kTicksPerStats == 0) write_stats(now, false);
    }
}

RunProgress Status::progress(const Snapshot& now) {
    RunProgress state = fixed_;
    state.elapsed = Clock::now() - begun_;
    const double passed = (state.elapsed - last_elapsed_).count();
    // Over half a second at least: shorter spans jump.
    if (passed >= 0.5) {
        event_rate_ = double(now.events - last_events_) / passed;
        last_events_ = now.events;
        last_elapsed_ = state.elapsed;
    }
    state.event_rate = event_rate_;
    return state;
}

void Status::write_stats(const Snapshot& now, bool final) {
    if (!stats_) return;
    RunProgress state = fixed_;
    state.elapsed = Clock::now() - begun_;
    const double seconds = state.elapsed.count();
    state.event_rate = final ? (seconds > 0 ? double(now.events) / seconds : 0) : event_rate_;
    try {
        stats_->write(stats_json(now, state, final) + "\n");
        stats_->publish();
        if (final) stats_->close();
    } catch (...) {  // told at the end: the run is worth more than its counters
        stats_failure_ = std::current_exception();
        stats_.reset();
    }
}

RunProgress Status::finish() {
    {
        const std::lock_guard lock{mutex_};
        end_ = true;
    }
    ended_.notify_all();
    if (thread_.joinable()) thread_.join();
    line_.clear();
    const Snapshot now = snapshot_();
    write_stats(now, true);
    if (stats_failure_) std::rethrow_exception(stats_failure_);
    RunProgress state = fixed_;
    state.elapsed = Clock::now() - begun_;
    return state;
}

}  // namespace eventide::app
