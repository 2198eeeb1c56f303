// Frame for Python.
#include "python/arrays.h"
#include "python/parts.h"

namespace eventide::python {

namespace py = pybind11;

py::object sigma_of(const Frame& frame, py::handle owner) {
    if (frame.sigma.empty()) return py::none();
    return array_of(frame.sigma, owner);
}

void add_frame(py::module_& module) {
    py::class_<Frame, FramePointer>(module, "Frame", "One rendered frame.")
        .def_property_readonly(
            "t", [](const Frame& f) { return to_us(f.t); }, "us, the instant")
        .def_readonly("index", &Frame::index, "number on the frame clock")
        .def_property_readonly(
            "window",
            [](const Frame& f) {
                return py::make_tuple(to_us(f.window.begin), to_us(f.window.end));
            },
            "us, (begin, end] of the event window t lies in")
        .def_readonly("events", &Frame::events, "events in that window")
        .def_readonly("gap_before", &Frame::gap_before, "data were lost before")
        .def_property_readonly(
            "intensity",
            [](const py::object& self) {
                return array_of(self.cast<const Frame&>().intensity, self);
            },
            "float32 [y, x], 0 black to 1 white; may lie a little outside")
        .def_property_readonly(
            "sigma",
            [](const py::object& self) { return sigma_of(self.cast<const Frame&>(), self); },
            "float32 [y, x], standard deviation of intensity; None where not asked for");
}

}  // namespace eventide::python
