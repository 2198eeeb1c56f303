// While a run goes on: the moving line on a terminal, and the JSON lines of --stats.
#include "apps/cli/run/report/status.h"

#include "src/core/image_clock.h"

#include <spdlog/spdlog.h>

#include <cmath>
#include <utility>

namespace eventide::app {

using Clock = std::chrono::steady_clock;

namespace {

constexpr std::chrono::milliseconds kTick{250};
constexpr int kTicksPerStats = 4;  // one line of JSON a second

}  // namespace

Status::Status(std::function<Snapshot()> snapshot, RunProgress fixed,
               std::unique_ptr<OutputFile> stats, bool quiet, bool live, ServiceManager& manager,
               Quality quality)
    : snapshot_{std::move(snapshot)},
      quality_{std::move(quality)},
      fixed_{std::move(fixed)},
      stats_{std::move(stats)},
      live_{live},
      line_{quiet},
      manager_{manager},
      begun_{Clock::now()} {
    manager_.ready();
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
        note_flicker(now.flicker);
        note_image_clock(now.images_apart);
        if (quality_) fixed_.quality = quality_(now, Clock::now() - begun_);
        const RunProgress state = progress(now);
        line_.show(status_line(now, state, line_.columns()));
        const bool second_is_over = n % kTicksPerStats == 0;
        if (second_is_over) write_stats(now, false);
        tell_manager(now, state, second_is_over);
    }
}

void Status::note_flicker(const FlickerFound& flicker) {
    if (flicker.hz <= 0 || flicker_said_) return;
    flicker_said_ = true;
    spdlog::info("light flickers at {} Hz: the events it adds are left out (--lamp-flicker)",
                 std::lround(flicker.hz));
}

void Status::note_image_clock(SensorDuration apart) {
    if (apart <= SensorDuration{0} || image_clock_said_) return;
    image_clock_said_ = true;
    spdlog::warn("{}; the images correct no frame", image_clock_text(apart));
}

/// The watchdog hears of work that was done since it heard last: a camera gives event windows in
/// silence, too, but for the time before its first data, which may be long in coming. A recording
/// may stand still for as long as its reader likes; what waits for a reader or the end of a pause
/// lives.
void Status::tell_manager(const Snapshot& now, const RunProgress& state, bool also_status) {
    if (!manager_.is_there()) return;
    const std::uint64_t work = now.packets + now.event_windows + now.frames + now.waits;
    const bool waits = now.packets == 0 || !live_;
    if (manager_.watchdog() && (work != last_work_ || waits)) manager_.alive();
    last_work_ = work;
    constexpr std::size_t kColumns = 120;
    if (also_status) manager_.status(status_line(now, state, kColumns));
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
    manager_.stopping();
    line_.clear();
    const Snapshot now = snapshot_();
    note_image_clock(now.images_apart);
    write_stats(now, true);
    if (stats_failure_) std::rethrow_exception(stats_failure_);
    RunProgress state = fixed_;
    state.elapsed = Clock::now() - begun_;
    return state;
}

}  // namespace eventide::app
