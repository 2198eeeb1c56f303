// A source of a Pipeline: a Reader, a Camera, or anything of Python's that can be iterated.
#pragma once

#include <eventide/pipeline.h>

#include <pybind11/pybind11.h>

#include <memory>

namespace eventide::python {

/// Is told when a run begins and ends. Python's lock is not held when it is called.
class RunSource : public EventSource {
public:
    /// Throws Error (usage) where another run is on, or was.
    virtual void begin() = 0;
    virtual void end() noexcept = 0;
};

/// 0 for a width or height that the source has itself. Throws Error (usage) where neither tells it,
/// and what iter() raises. `sequential`: run() reads on Python's main thread.
std::unique_ptr<RunSource> run_source(const pybind11::object& source, int width, int height,
                                      bool sequential);

}  // namespace eventide::python
