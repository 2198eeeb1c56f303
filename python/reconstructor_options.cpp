// Options of a Reconstructor by name, size and rate.
#include "python/reconstructor_options.h"

#include "python/parts.h"
#include "src/core/arithmetic_words.h"

#include <eventide/error.h>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cmath>
#include <filesystem>

namespace eventide::python {

namespace py = pybind11;

FrameSize size_of(const Size& size, const Roi& roi, FrameSize otherwise) {
    if (size) {
        otherwise = {size->first, size->second, {}};
        if (otherwise.width < 1 || otherwise.height < 1)
            throw Error(ErrorKind::usage, "size: expected (width, height) of at least 1, found (" +
                                              std::to_string(size->first) + ", " +
                                              std::to_string(size->second) + ")");
    }
    if (roi) otherwise.region = {(*roi)[0], (*roi)[1], (*roi)[2], (*roi)[3]};
    return otherwise;
}

namespace {

/// The simplest fraction that a float stands for: 60000/1001 of 59.94005994005994.
std::string fraction_of(const py::handle& number) {
    const double value = py::float_(py::reinterpret_borrow<py::object>(number));
    if (!std::isfinite(value)) return std::to_string(value);
    constexpr int kLargestDenominator = 1'000'000;
    const py::object fraction = py::module_::import("fractions").attr("Fraction")(value);
    const py::object simple = fraction.attr("limit_denominator")(kLargestDenominator);
    if (!py::bool_(simple)) return py::str(number);  // 0, or nearly: refused as it was written
    return py::str(simple);
}

}  // namespace

std::string rate_of(const py::handle& fps) {
    if (py::isinstance<py::str>(fps)) return fps.cast<std::string>();
    if (PyIndex_Check(fps.ptr()) && !PyBool_Check(fps.ptr())) return py::str(fps);
    if (PyNumber_Check(fps.ptr()) && !PyBool_Check(fps.ptr())) return fraction_of(fps);
    throw py::type_error("fps: expected int, float or str, found " + std::string(py::repr(fps)));
}

ReconstructorOptions options_of(const py::dict& given) {
    ReconstructorOptions options;
    Size size;
    Roi roi;
    for (const auto& [key, value] : given) {
        const auto name = key.cast<std::string>();
        if (name == "window")
            options.window = cast_to<std::string>("window", value);
        else if (name == "lookahead")
            options.lookahead = cast_to<int>("lookahead", value);
        else if (name == "fps")
            options.fps = rate_of(value);
        else if (name == "size")
            size = cast_to<Size>("size", value);
        else if (name == "roi")
            roi = cast_to<Roi>("roi", value);
        else if (name == "sigma")
            options.sigma = cast_to<bool>("sigma", value);
        else if (name == "hot_pixels")
            options.hot_pixels = cast_to<std::filesystem::path>("hot_pixels", value).string();
        else if (name == "noise_filter")
            options.noise_filter = cast_to<std::string>("noise_filter", value);
        else if (name == "lamp_flicker")
            options.lamp_flicker = cast_to<std::string>("lamp_flicker", value);
        else if (name == "precision")
            options.precision =
                option_word("precision", cast_to<std::string>("precision", value), kPrecisionWords);
        else if (name == "kernels")
            options.kernels =
                option_word("kernels", cast_to<std::string>("kernels", value), kKernelWords);
        else if (name == "threads")
            options.threads = cast_to<int>("threads", value);
        else if (name == "self_ensemble")
            options.self_ensemble = cast_to<int>("self_ensemble", value);
        else if (name == "reset_on_gap")
            options.reset_on_gap = cast_to<bool>("reset_on_gap", value);
        else if (name == "images")
            options.images = cast_to<bool>("images", value);
        else if (name == "allow_silence")
            options.allow_silence = cast_to<bool>("allow_silence", value);
        else
            throw Error(ErrorKind::usage, "expected an option of Reconstructor, found " + name);
    }
    options.size = size_of(size, roi);
    return options;
}

}  // namespace eventide::python
