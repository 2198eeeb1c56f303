// What a service manager hears until a run goes on.
#include "apps/cli/run/start_watch.h"

#include <utility>

namespace eventide::app {

StartWatch::StartWatch(ServiceManager& manager, std::string source,
                       std::chrono::milliseconds longest)
    : manager_{manager}, source_{std::move(source)}, longest_{longest} {}

void StartWatch::source_is_waited_for() {
    goes_on();
    const auto now = Clock::now();
    if (now < next_) return;
    next_ = now + kTick;
    manager_.ready();
    manager_.status("waiting for " + source_);
    if (manager_.watchdog() && !thread_.joinable()) thread_ = std::thread{[this] { beat(); }};
}

void StartWatch::goes_on() {
    alive_until_ = Clock::now() + longest_;
}

void StartWatch::beat() {
    std::unique_lock lock{mutex_};
    do {
        if (Clock::now() < alive_until_.load()) manager_.alive();
    } while (!ended_.wait_for(lock, kTick, [this] { return end_; }));
}

void StartWatch::end() {
    {
        const std::lock_guard lock{mutex_};
        end_ = true;
    }
    ended_.notify_all();
    if (thread_.joinable()) thread_.join();
}

}  // namespace eventide::app
