// Ctrl-C, where C++ works for long without a line of Python between.
#pragma once

#include "python/lock.h"

#include <pybind11/pybind11.h>

namespace eventide::python {

/// With Python's lock. Throws what the handler of a signal raised, such as KeyboardInterrupt.
inline void check_signals() {
    if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
}

/// The same of a library that works without Python's lock.
inline void hear_signals() {
    with_lock(check_signals);
}

}  // namespace eventide::python
