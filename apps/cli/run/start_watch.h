// What a service manager hears while a source is waited for, and from then on until the run goes
// on.
#pragma once

#include "apps/cli/service_manager.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace eventide::app {

/// A start has a time limit and a source that is waited for without one has none, so the service
/// counts as started from the first such wait on. From then on the manager's watchdog runs, though
/// the network has to be loaded, the processor measured and outputs opened: it hears that the
/// program is alive for as long as a start may take, counted anew from each wait. What hangs longer
/// is the watchdog's to end. Thread: the one that opens the source, and one of its own.
class StartWatch {
public:
    /// As systemd's DefaultTimeoutStartSec.
    static constexpr std::chrono::seconds kLongestStart{90};

    /// `source`: its name, for people. `manager` is borrowed. `longest` is for tests.
    StartWatch(ServiceManager& manager, std::string source,
               std::chrono::milliseconds longest = kLongestStart);
    ~StartWatch() { end(); }
    StartWatch(const StartWatch&) = delete;
    StartWatch& operator=(const StartWatch&) = delete;

    /// Called again and again while the source has nothing.
    void source_is_waited_for();
    /// The same while something else without a limit is waited for, such as the reader of a pipe.
    void goes_on();
    /// The run tells the manager itself from here on.
    void end();

private:
    using Clock = std::chrono::steady_clock;
    static constexpr std::chrono::milliseconds kTick{250};
    void beat();

    ServiceManager& manager_;
    const std::string source_;
    const std::chrono::milliseconds longest_;
    Clock::time_point next_{};
    std::atomic<Clock::time_point> alive_until_{};

    std::mutex mutex_;
    std::condition_variable ended_;
    bool end_ = false;  // by mutex_
    std::thread thread_;
};

}  // namespace eventide::app
