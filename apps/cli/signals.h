// SIGINT, SIGTERM and SIGHUP: the first ends the work properly, the second at once.
#pragma once

#include <signal.h>

#include <functional>
#include <mutex>
#include <thread>
#include <utility>

namespace eventide::app {

/// Made first thing in main, one per process, and the only one who handles the three signals
/// while it lives. They may arrive on any thread: libraries start some before main does (OpenBLAS,
/// where OpenCV brings it). The calling thread, and so all made later, block them, lest their
/// system calls be interrupted. SIGPIPE and SIGXFSZ are ignored.
class Signals {
public:
    /// Throws Error(failed) where the system has no file descriptors left.
    Signals();
    ~Signals();
    Signals(const Signals&) = delete;
    Signals& operator=(const Signals&) = delete;

    /// A signal came. Any thread.
    bool stopping() const;

    /// What the first signal calls, on the signals' thread; at once if it came already. The second
    /// ends the process even if this hangs.
    void on_stop(std::function<void()> stop);

private:
    using Action = struct sigaction;
    void wait();

    sigset_t mask_before_{};
    Action interrupt_before_{}, terminate_before_{}, hangup_before_{};
    int read_end_ = -1, write_end_ = -1;  // a byte per signal; none left when it is over
    std::mutex mutex_;                    // guards stop_
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
