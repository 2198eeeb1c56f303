// Python's lock, taken and let go of by threads that may outlive the interpreter.
#pragma once

#include <pybind11/pybind11.h>

#include <cxxabi.h>
#include <unistd.h>

namespace eventide::python {

/// What `call` gives, which wants Python's lock. Where the interpreter has ended meanwhile, Python
/// before 3.14 unwinds the stack of a daemon thread that wants it, and the destructors of C++ on
/// the way end the process with an error. Such a thread stays here until the process has ended, as
/// it does by itself from 3.14 on.
template <typename Call>
auto or_stay(Call call) {
    try {
        return call();
    } catch (const abi::__forced_unwind&) {
        for (;;) pause();
    }
}

/// Without Python's lock, which the thread has, until the end of the scope.
class Unlocked {
public:
    Unlocked() : state_(PyEval_SaveThread()) {}
    ~Unlocked() {
        or_stay([this] { PyEval_RestoreThread(state_); });
    }
    Unlocked(const Unlocked&) = delete;
    Unlocked& operator=(const Unlocked&) = delete;

private:
    PyThreadState* const state_;
};

/// With Python's lock until the end of the scope.
class Locked {
public:
    Locked() : state_(or_stay(&taken)) {}
    ~Locked() { PyGILState_Release(state_); }
    Locked(const Locked&) = delete;
    Locked& operator=(const Locked&) = delete;

private:
    /// A thread that is none of Python's becomes one, which is too late once the interpreter ends.
    static PyGILState_STATE taken() {
        if (PyGILState_GetThisThreadState() == nullptr)
            while (Py_IsInitialized() == 0) pause();
        return PyGILState_Ensure();
    }

    const PyGILState_STATE state_;
};

/// Runs `body` with Python's lock. Thread: any, Python's or not.
template <typename Body>
auto with_lock(Body body) {
    const Locked locked;
    return or_stay(body);
}

}  // namespace eventide::python
