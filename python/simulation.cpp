// Simulations for Python.
#include "python/arrays.h"
#include "python/parts.h"
#include "python/signals.h"

#include <eventide/simulation.h>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <string>
#include <vector>

namespace eventide::python {

namespace py = pybind11;

namespace {

using Simulation = Guarded<EventSimulation>;

/// (events, [(t, truth), ...]) of the next 10 ms.
py::tuple next(Simulation& simulation) {
    check_signals();
    Batch batch;
    std::vector<TrueImage> truths;
    if (!simulation.with([&](EventSimulation& it) { return it.read(batch, truths); }))
        throw py::stop_iteration();
    py::list images;
    for (TrueImage& truth : truths)
        images.append(py::make_tuple(to_us(truth.t), array_of(std::move(truth.intensity))));
    return py::make_tuple(array_of(std::move(batch.events)), images);
}

}  // namespace

void add_simulation(py::module_& module) {
    const SimulationOptions defaults;
    py::class_<Simulation>(module, "Simulation",
                           "A camera in software; iterate it for (events, [(t, truth), ...]) of "
                           "10 ms each.")
        .def(py::init([](std::string scene, std::pair<int, int> size, double seconds,
                         std::uint64_t seed, double truths_per_second, double truth_scale,
                         std::filesystem::path textures) {
                 const Unlocked unlocked;
                 SimulationOptions options;
                 options.scene = std::move(scene);
                 options.seed = seed;
                 options.width = size.first;
                 options.height = size.second;
                 options.seconds = seconds;
                 options.truths_per_second = truths_per_second;
                 options.truth_scale = truth_scale;
                 options.textures = std::move(textures);
                 return std::make_unique<Simulation>(options);
             }),
             py::arg("scene") = defaults.scene,
             py::arg("size") = std::pair{defaults.width, defaults.height},
             py::arg("seconds") = defaults.seconds, py::kw_only(), py::arg("seed") = defaults.seed,
             py::arg("truths_per_second") = defaults.truths_per_second,
             py::arg("truth_scale") = defaults.truth_scale, py::arg("textures") = "")
        .def("__iter__", [](const py::object& self) { return self; })
        .def("__next__", &next)
        .def_property_readonly(
            "width", [](Simulation& s) { return s.it.width(); }, "px, of the sensor")
        .def_property_readonly(
            "height", [](Simulation& s) { return s.it.height(); }, "px, of the sensor")
        .def_property_readonly(
            "clock",
            [](Simulation& s) {
                return to_us(s.with([](EventSimulation& it) { return it.clock(); }));
            },
            "us, all before it has been read")
        .def_static("scenes", &EventSimulation::scenes, "names of the scenes");
}

}  // namespace eventide::python
