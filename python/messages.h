// What the library tells people, in Python.
#pragma once

#include "python/lock.h"

#include <pybind11/pybind11.h>

#include <string>
#include <string_view>

namespace eventide::python {

/// Names of files in a message may be no UTF-8. Null where MemoryError is set.
inline pybind11::object text_of(std::string_view words) {
    return pybind11::reinterpret_steal<pybind11::object>(
        PyUnicode_DecodeUTF8(words.data(), pybind11::ssize_t(words.size()), "replace"));
}

/// To the logger "eventide", of a library that works without Python's lock. Throws what a handler
/// of it, or of a signal meanwhile, raised.
inline void log_warning(const std::string& words) {
    with_lock([&] {
        const pybind11::object text = text_of(words);
        if (!text) throw pybind11::error_already_set();
        const pybind11::object logging = pybind11::module_::import("logging");
        logging.attr("getLogger")("eventide").attr("warning")("%s", text);
    });
}

}  // namespace eventide::python
