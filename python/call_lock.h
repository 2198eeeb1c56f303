// One call of an object at a time.
#pragma once

#include <eventide/error.h>

#include <pybind11/pybind11.h>

#include <atomic>
#include <mutex>

namespace eventide::python {

/// A mutex that refuses the thread that holds it, instead of waiting for ever: while the library
/// waits in a call, the handler of a signal or of a warning may call the same object.
class CallLock {
public:
    /// Throws Error (usage).
    void lock() {
        if (is_held_here())
            throw Error(ErrorKind::usage,
                        "expected one call at a time, found one within another of the same object, "
                        "as by the handler of a signal");
        mutex_.lock();
        holder_ = PyThread_get_thread_ident();
    }
    void unlock() {
        holder_ = kNobody;
        mutex_.unlock();
    }
    bool is_held_here() const { return holder_ == PyThread_get_thread_ident(); }

private:
    static constexpr unsigned long kNobody = PYTHREAD_INVALID_THREAD_ID;

    std::mutex mutex_;
    std::atomic<unsigned long> holder_{kNobody};
};

}  // namespace eventide::python
