// What frames are judged by, for Python.
#include "python/arrays.h"
#include "python/parts.h"

#include <eventide/simulation.h>

#include <pybind11/stl.h>

namespace eventide::python {

namespace py = pybind11;

void add_measures(py::module_& module) {
    module.def(
        "evaluate",
        [](const py::array& intensity, const py::array& truth, const py::object& sigma) {
            const Array2<float> shown = plane_of(intensity, "intensity"),
                                expected = plane_of(truth, "truth");
            Array2<float> doubt;
            if (!sigma.is_none()) doubt = plane_of(sigma.cast<py::array>(), "sigma");
            FrameMeasures m;
            {
                const py::gil_scoped_release released;
                m = measure(shown, doubt, expected);
            }
            py::dict measures;
            measures["mse"] = m.mse;
            measures["ssim"] = m.ssim;
            measures["affine_mse"] = m.affine_mse;
            measures["affine_ssim"] = m.affine_ssim;
            measures["picp80"] = m.picp80;
            measures["log_likelihood"] = m.log_likelihood;
            return measures;
        },
        py::arg("intensity"), py::arg("truth"), py::arg("sigma") = py::none(),
        "How far a frame is from the truth (mse, ssim, both after a fit of gain and offset), and "
        "whether sigma knew (picp80, .8 is right; log_likelihood); None where there is no sigma.");
}

}  // namespace eventide::python
