// The Python module: its parts, in the order in which they need each other.
#include "python/parts.h"

#include <eventide/version.h>

PYBIND11_MODULE(_eventide, module) {
    module.attr("__version__") = eventide::version();
    eventide::python::add_errors(module);
    eventide::python::add_reconstructor(module);
    eventide::python::add_sources(module);
    eventide::python::add_simulation(module);
    eventide::python::add_measures(module);
    eventide::python::add_pipeline(module);
}
