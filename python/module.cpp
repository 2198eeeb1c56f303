// The Python module: its parts, in the order in which they need each other.
#include "python/parts.h"

#include <eventide/version.h>

#include <cstddef>

namespace eventide::python {

namespace py = pybind11;

namespace {

/// Of an object whose __init__ did not run (of cls.__new__(cls), or in the __init__ of a derived
/// class before that of its base) pybind11 would make an object of memory that nobody has written.
void refuse_uninitialised(const py::module_& module) {
    for (const auto& [name, value] : module.attr("__dict__").cast<py::dict>()) {
        if (PyType_Check(value.ptr()) == 0) continue;
        auto* const type = py::detail::get_type_info(reinterpret_cast<PyTypeObject*>(value.ptr()));
        if (type == nullptr) continue;  // an exception
        type->operator_new = [](std::size_t) -> void* {
            throw py::type_error(
                "expected an object of the module eventide, found one whose __init__ did not run");
        };
    }
}

}  // namespace
}  // namespace eventide::python

PYBIND11_MODULE(_eventide, module) {
    module.attr("__version__") = eventide::version();
    eventide::python::add_errors(module);
    eventide::python::add_reconstructor(module);
    eventide::python::add_sources(module);
    eventide::python::add_simulation(module);
    eventide::python::add_measures(module);
    eventide::python::add_pipeline(module);
    eventide::python::refuse_uninitialised(module);
}
