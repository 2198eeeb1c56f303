// SIGINT and SIGTERM: the first ends the work properly, the second at once.
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

namespace eventide::app {

/// Made first thing in main, before any thread: it blocks the two signals in the calling thread,
/// and so in all threads made later, and waits for them on a thread of its own. SIGPIPE is ignored.
class Signals {
public:
    Signals();
    ~Signals();
    Signals(const Signals&) = delete;
    Signals& operator=(const Signals&) = delete;

    /// A signal came. Any thread.
    bool stopping() const { return stopping_; }

    /// What the first signal calls, on the signals' thread; at once if it came already.
    void on_stop(std::function<void()> stop);

private:
    void wait();

    std::atomic<bool> stopping_{false}, done_{false};
    std::mutex mutex_;  // guards stop_
    std::function<void()> stop_;
    std::jthread thread_;
};

/// What to call, for as long as there is something to stop.
class Stopper {
public:
    Stopper(Signals& signals, std::function<void()> stop) : signals_{signals} {
        signals_.on_stop(std::move(stop));
    }
    ~Stopper() { signals_.on_stop({}); }
    Stopper(const Stopper&) = delete;
    Stopper& operator=(const Stopper&) = delete;

private:
    Signals& signals_;
};

}  // namespace eventide::app
