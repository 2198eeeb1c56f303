// The iteration over a source of Python's.
#pragma once

#include <eventide/event.h>

#include <pybind11/pybind11.h>

#include <exception>
#include <optional>

namespace eventide::python {

/// None where there is none. Asked for once, as a property may give what is new only once; what it
/// raises comes out.
pybind11::object attribute_of(const pybind11::object& source, const char* name);

/// What the source gave and told.
struct Answer {
    Batch batch;
    std::optional<SensorTime> clock;
    bool gap_before = false;
    bool more = false;
    std::exception_ptr error;
};

/// Python's lock is held for its construction and by stop(); others take it.
class Iteration {
public:
    /// Throws what iter() raises.
    explicit Iteration(const pybind11::object& source);
    ~Iteration();
    Iteration(const Iteration&) = delete;
    Iteration& operator=(const Iteration&) = delete;

    bool is_live() const { return live_; }
    Answer next() noexcept;
    /// stop() of the source, where it has one.
    void stop();
    /// What it holds, for Python's collector of circles.
    template <typename Visit>
    int visit(Visit visit) const {
        const int stopped = visit(source_.ptr());
        return stopped != 0 ? stopped : visit(events_.ptr());
    }
    /// Nobody waits for next() any more: ends it where Python works, while it waits nothing can.
    void give_up();

private:
    /// With Python's lock, as all below.
    void ask(Answer& answer);

    pybind11::object source_;
    pybind11::object events_;
    const bool live_;
    unsigned long asks_ = 0;  // the thread that is in next(), as Python numbers them
};

}  // namespace eventide::python
