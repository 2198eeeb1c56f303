// The library's errors as exceptions of Python, with the same words.
#include "python/messages.h"
#include "python/parts.h"

#include <eventide/error.h>

#include <string>

namespace eventide::python {

namespace py = pybind11;

namespace {

struct Exceptions {
    PyObject *error, *usage, *input, *device;
};

/// The module's, for as long as the process lives.
Exceptions exceptions{};

PyObject* make(py::module_& module, const char* name, const char* meaning, py::handle bases) {
    const std::string full = std::string{"eventide."} + name;
    PyObject* const made = PyErr_NewExceptionWithDoc(full.c_str(), meaning, bases.ptr(), nullptr);
    if (made == nullptr) throw py::error_already_set();
    module.attr(name) = py::handle(made);
    return made;
}

PyObject* exception_of(ErrorKind kind) {
    switch (kind) {
        case ErrorKind::usage:
            return exceptions.usage;
        case ErrorKind::input:
            return exceptions.input;
        case ErrorKind::device:
            return exceptions.device;
        case ErrorKind::failed:
            break;
    }
    return exceptions.error;
}

void raise(const Error& error) {
    const py::object text = text_of(error.what());
    if (text) PyErr_SetObject(exception_of(error.kind()), text.ptr());  // else: MemoryError is set
}

}  // namespace

void add_errors(py::module_& module) {
    exceptions.error = make(module, "Error", "Something went wrong: what was expected and found.",
                            PyExc_RuntimeError);
    const py::handle error = exceptions.error;
    exceptions.usage = make(module, "UsageError", "An argument or option: the caller's to change.",
                            py::make_tuple(error, py::handle(PyExc_ValueError)));
    exceptions.input =
        make(module, "InputError",
             "A recording or model that cannot be read or is not what it says.", error);
    exceptions.device = make(module, "DeviceError",
                             "A camera that is missing, cannot be used, or was lost.", error);
    // pybind11 takes functions of a value.
    // NOLINTNEXTLINE(performance-unnecessary-value-param)
    py::register_exception_translator([](std::exception_ptr thrown) {
        try {
            if (thrown) std::rethrow_exception(thrown);
        } catch (const Error& found) {
            raise(found);
        }
    });
}

}  // namespace eventide::python
