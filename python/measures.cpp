// What frames are judged by, for Python.
#include "python/arrays.h"
#include "python/parts.h"

#include <eventide/simulation.h>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

namespace eventide::python {

namespace py = pybind11;

void add_measures(py::module_& module) {
    py::class_<PerceptualDistance>(module, "PerceptualDistance",
                                   "LPIPS v0.1, with the weights of an npz file.")
        .def(py::init<const std::filesystem::path&>(), py::arg("weights"))
        .def_property_readonly("name", &PerceptualDistance::name, "LPIPS-Squeeze or LPIPS-Alex")
        .def(
            "between",
            [](const PerceptualDistance& lpips, const py::array& a, const py::array& b) {
                const Array2<float> first = plane_of(a, "a"), second = plane_of(b, "b");
                const Unlocked unlocked;
                return lpips.between(first, second);
            },
            py::arg("a"), py::arg("b"), "0 for equal images, about .7 for unlike ones.");
    module.def(
        "evaluate",
        [](const py::array& intensity, const py::array& truth, const py::object& sigma,
           const PerceptualDistance* lpips) {
            const Array2<float> shown = plane_of(intensity, "intensity"),
                                expected = plane_of(truth, "truth");
            Array2<float> doubt;
            if (!sigma.is_none()) doubt = plane_of(sigma.cast<py::array>(), "sigma");
            FrameMeasures m;
            {
                const Unlocked unlocked;
                m = measure(shown, doubt, expected, lpips);
            }
            py::dict measures;
            measures["mse"] = m.mse;
            measures["ssim"] = m.ssim;
            measures["affine_mse"] = m.affine_mse;
            measures["affine_ssim"] = m.affine_ssim;
            measures["picp80"] = m.picp80;
            measures["log_likelihood"] = m.log_likelihood;
            measures["lpips"] = m.lpips;
            return measures;
        },
        py::arg("intensity"), py::arg("truth"), py::arg("sigma") = py::none(),
        py::arg("lpips") = static_cast<PerceptualDistance*>(nullptr),
        "How far a frame is from the truth, both floats [y, x], 0 black to 1 white (mse, ssim, "
        "both after a fit of gain and offset), and "
        "whether sigma knew (picp80, .8 is right; log_likelihood); None where there is no sigma, "
        "or for lpips no PerceptualDistance.");
}

}  // namespace eventide::python
