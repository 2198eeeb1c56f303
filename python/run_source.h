// A source of a Pipeline: a Reader, a Camera, or anything of Python's that can be iterated.
#pragma once

#include <eventide/pipeline.h>

#include <pybind11/pybind11.h>

#include <functional>
#include <memory>

namespace eventide::python {

/// Is told when a run begins and ends. Python's lock is not held when it is called.
class RunSource : public EventSource {
public:
    /// Throws Error (usage) where another run is on, or was.
    virtual void begin() = 0;
    virtual void end() noexcept = 0;

    /// For Python's collector of circles, which has its lock: calls `visit` with each object held,
    /// until it gives anything but 0, and returns that.
    virtual int visit(const std::function<int(PyObject*)>& visit) const = 0;
    /// Lets go of them, where it can do without; Python's lock is held. Nothing runs.
    virtual void clear() = 0;
};

/// 0 for a width or height that the source has itself. Throws Error (usage) where neither tells it,
/// and what iter() raises. `sequential`: run() reads on Python's main thread.
std::unique_ptr<RunSource> run_source(const pybind11::object& source, int width, int height,
                                      bool sequential);

}  // namespace eventide::python
