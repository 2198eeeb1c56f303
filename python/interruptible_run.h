// A run that Ctrl-C ends: the thread that waits for it hears Python's signals, and makes its calls
// into Python.
#pragma once

#include "python/signals.h"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

namespace eventide::python {

/// Who runs is Python's main thread, mostly, and the only one that can be interrupted. Nobody holds
/// Python's lock when calling.
class InterruptibleRun {
public:
    /// Runs `body` on a thread of its own, and makes here the calls that it passes to call_there().
    /// Throws what `body` threw. Where a signal is raised as an exception, `stop` is called, no
    /// work is done any more, and once `body` has ended that is thrown.
    template <typename Body, typename Stop>
    void run(Body body, Stop stop) {
        std::exception_ptr error, interruption;
        {
            const std::jthread running{[&] {
                error = error_of(body);
                close();
            }};
            while (wait()) {
                if (!interruption && (interruption = error_of(hear_signals))) stop();
                answer(interruption);
            }
        }
        for (const std::exception_ptr& each : {interruption, error})
            if (each) std::rethrow_exception(each);
    }

    /// On the thread of `body`: returns when `work` was done. Throws what that threw.
    void call_there(const std::function<void()>& work) {
        std::unique_lock lock{mutex_};
        work_ = &work;
        changed_.notify_all();
        changed_.wait(lock, [this] { return work_ == nullptr; });
        if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
    }

private:
    static constexpr std::chrono::milliseconds kHearsEvery{20};

    template <typename Body>
    static std::exception_ptr error_of(const Body& body) {
        try {
            body();
        } catch (...) {
            return std::current_exception();
        }
        return nullptr;
    }
    void close() {
        const std::lock_guard lock{mutex_};
        closed_ = true;
        changed_.notify_all();
    }
    /// For work, or for as long as signals may wait; false after close().
    bool wait() {
        std::unique_lock lock{mutex_};
        changed_.wait_for(lock, kHearsEvery, [this] { return work_ != nullptr || closed_; });
        return !closed_;
    }
    /// Does the work, where there is some; after an interruption it is told that instead.
    void answer(const std::exception_ptr& interruption) {
        std::unique_lock lock{mutex_};
        if (work_ == nullptr) return;
        lock.unlock();
        std::exception_ptr error = interruption ? interruption : error_of(*work_);
        lock.lock();
        error_ = std::move(error);
        work_ = nullptr;
        changed_.notify_all();
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    const std::function<void()>* work_ = nullptr;
    std::exception_ptr error_;
    bool closed_ = false;
};

}  // namespace eventide::python
