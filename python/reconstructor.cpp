// Reconstructor for Python.
#include "python/arrays.h"
#include "python/parts.h"
#include "python/reconstructor_options.h"
#include "python/signals.h"
#include "src/core/arithmetic_words.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace eventide::python {

namespace py = pybind11;

namespace {

std::unique_ptr<GuardedReconstructor> make(const std::filesystem::path& model, int width,
                                           int height, std::string window, int lookahead,
                                           const py::object& fps, Size size, Roi roi, bool sigma,
                                           const std::filesystem::path& hot_pixels,
                                           std::string noise_filter, const std::string& precision,
                                           const std::string& kernels, int threads,
                                           bool reset_on_gap, bool allow_silence, bool images,
                                           std::string lamp_flicker, int self_ensemble) {
    const ReconstructorOptions options{
        .window = std::move(window),
        .lookahead = lookahead,
        .fps = rate_of(fps),
        .size = size_of(size, roi),
        .sigma = sigma,
        .noise_filter = std::move(noise_filter),
        .lamp_flicker = std::move(lamp_flicker),
        .images = images,
        .hot_pixels = hot_pixels.string(),
        .precision = option_word("precision", precision, kPrecisionWords),
        .kernels = option_word("kernels", kernels, kKernelWords),
        .threads = threads,
        .self_ensemble = self_ensemble,
        .reset_on_gap = reset_on_gap,
        .allow_silence = allow_silence};
    const Unlocked unlocked;
    return std::make_unique<GuardedReconstructor>(model.string(), width, height, options);
}

void push(GuardedReconstructor& self, const py::array& events, bool resets) {
    Batch batch;
    in_pieces(events, batch.events, [&] {
        self.with([&](Reconstructor& it) {
            if (resets)
                it.push(batch);
            else
                it.push(std::span<const Event>{batch.events});
        });
    });
}

void push_image(GuardedReconstructor& self, std::int64_t t, const py::array& pixels,
                const std::optional<std::pair<std::int64_t, std::int64_t>>& exposure,
                std::pair<int, int> at) {
    Batch batch;
    ReferenceImage image = image_of(pixels);
    image.t = from_us(t);
    image.exposure_begin = from_us(exposure ? exposure->first : t);
    image.exposure_end = from_us(exposure ? exposure->second : t);
    image.x0 = at.first;
    image.y0 = at.second;
    batch.images.push_back(std::move(image));
    self.with([&](Reconstructor& it) { it.push(batch); });
}

FramePointer next(GuardedReconstructor& self) {
    auto frame = std::make_shared<Frame>();
    return self.with([&](Reconstructor& it) { return it.next(*frame); }) ? frame : nullptr;
}

py::tuple render(GuardedReconstructor& self, std::int64_t t, const Size& size, const Roi& roi) {
    auto frame = std::make_shared<Frame>();
    const FrameSize wanted = size_of(size, roi, self.size);
    self.with([&](Reconstructor& it) { it.render(from_us(t), wanted, *frame); });
    const py::object owner = py::cast(frame);
    return py::make_tuple(array_of(frame->intensity, owner), sigma_of(*frame, owner));
}

std::map<std::string, std::uint64_t> counters(GuardedReconstructor& self) {
    const auto c = self.with([](Reconstructor& it) { return it.counters(); });
    return {{"events", c.events},
            {"off_sensor", c.off_sensor},
            {"time_backwards", c.time_backwards},
            {"bad_time", c.bad_time},
            {"filtered", c.filtered},
            {"late", c.late},
            {"left_out", c.left_out},
            {"time_resets", c.time_resets},
            {"event_windows", c.event_windows},
            {"frames", c.frames},
            {"used_images", c.used_images},
            {"dropped_images", c.dropped_images}};
}

/// What `for frame in reconstructor.frames()` goes through.
struct Frames {
    py::object owner;
    GuardedReconstructor& of;
};

void add_iterator(py::module_& module) {
    py::class_<Frames>(module, "_Frames")
        .def("__iter__", [](const py::object& self) { return self; })
        .def("__next__", [](Frames& self) {
            check_signals();
            FramePointer frame = next(self.of);
            if (!frame) throw py::stop_iteration();
            return frame;
        });
}

template <typename Class>
void add_events_in(Class& it) {
    it.def(
          "push", &push, py::arg("events"), py::arg("resets") = false,
          "Events in order of time: a structured array with the fields t (us), x, y and p, on, pol "
          "or polarity. One earlier than the one before is left out and counted or, with resets, "
          "begins a new stream, as after a reset of the camera's clock. Ctrl-C ends it between "
          "two events: counters tell how many are in.")
        .def(
            "push_image", &push_image, py::arg("t"), py::arg("image"),
            py::arg("exposure") = py::none(), py::arg("at") = std::pair{0, 0},
            "An image that the camera took beside its events, before the events that follow it: "
            "uint8 or uint16 [y, x], [y, x, 3] in BGR or [y, x, 4] in BGRA. t (us) is the middle "
            "of its exposure, "
            "exposure its begin and end, at (x, y) its upper left corner in the sensor. Frames are "
            "corrected by it. read_into() of a Reader or Camera does this by itself.")
        .def(
            "advance",
            [](GuardedReconstructor& self, std::int64_t now) {
                self.with([&](Reconstructor& r) { r.advance(from_us(now)); });
            },
            py::arg("now"), "Every event before now (us) was pushed: time goes on in silence.")
        .def(
            "mark_gap",
            [](GuardedReconstructor& self) { self.with([](Reconstructor& r) { r.mark_gap(); }); },
            "Data were lost here: the next frame carries gap_before.")
        .def(
            "finish",
            [](GuardedReconstructor& self, std::optional<std::int64_t> end) {
                self.with([&](Reconstructor& r) {
                    r.finish(end ? std::optional{from_us(*end)} : std::nullopt);
                });
            },
            py::arg("end") = py::none(),
            "The stream has ended, at end (us) where its clock went on after the last event.")
        .def(
            "reset",
            [](GuardedReconstructor& self) { self.with([](Reconstructor& r) { r.reset(); }); },
            "As constructed: a new stream begins.");
}

/// Copies nothing of bytes.
py::bytes bytes_of(const py::buffer& buffer) {
    PyObject* const bytes = PyBytes_FromObject(buffer.ptr());
    if (bytes == nullptr) throw py::error_already_set();
    return py::reinterpret_steal<py::bytes>(bytes);
}

template <typename Class>
void add_state(Class& it) {
    it.def(
          "state",
          [](GuardedReconstructor& self) {
              const auto state = self.with([](Reconstructor& r) { return r.state(); });
              return py::bytes(reinterpret_cast<const char*>(state.data()), state.size());
          },
          "What the network remembers of the scene, as bytes for restore().")
        .def(
            "restore",
            [](GuardedReconstructor& self, const py::buffer& state) {
                const auto bytes = bytes_of(state);
                const std::string_view view = bytes;
                self.with([&](Reconstructor& r) { r.restore(std::as_bytes(std::span{view})); });
            },
            py::arg("state"),
            "A new stream begins with what state() told, of the same model and sensor size: bytes, "
            "or what holds some (a memoryview, an array of uint8).")
        .def(
            "save_state",
            [](GuardedReconstructor& self, const std::filesystem::path& file, bool overwrite) {
                self.with([&](Reconstructor& r) { r.save_state(file, overwrite); });
            },
            py::arg("file"), py::arg("overwrite") = false, "state() as a file.")
        .def(
            "restore_state",
            [](GuardedReconstructor& self, const std::filesystem::path& file) {
                self.with([&](Reconstructor& r) { r.restore_state(file); });
            },
            py::arg("file"), "restore() from a file.");
}

template <typename Class>
void add_frames_out(Class& it) {
    it.def("next", &next, "The next Frame at the rate fps, or None: more events are needed.")
        .def(
            "frames",
            [](const py::object& self) {
                return Frames{self, self.cast<GuardedReconstructor&>()};
            },
            "An iterator over the frames that the events pushed so far give.")
        .def(
            "ready",
            [](GuardedReconstructor& self, std::int64_t t) {
                return self.with([&](Reconstructor& r) { return r.ready(from_us(t)); });
            },
            py::arg("t"), "Whether the frame of this time (us) can be rendered.")
        .def(
            "newest",
            [](GuardedReconstructor& self) {
                return us_of(self.with([](Reconstructor& r) { return r.newest(); }));
            },
            "The newest time (us) that can be rendered, or None.")
        .def("render", &render, py::arg("t"), py::arg("size") = py::none(),
             py::arg("roi") = py::none(),
             "(intensity, sigma) at a time (us) that is ready: float32 arrays [y, x]. size is "
             "(width, height), roi (x, y, width, height) of the part wanted. Without both: as "
             "constructed; with size alone: all of the frame.")
        .def_property_readonly(
            "width", [](GuardedReconstructor& self) { return self.it.width(); },
            "px, of the sensor")
        .def_property_readonly(
            "height", [](GuardedReconstructor& self) { return self.it.height(); },
            "px, of the sensor")
        .def_property_readonly(
            "description", [](GuardedReconstructor& self) { return self.it.description(); },
            "which kernels and numbers run")
        .def_property_readonly("counters", &counters, "what became of what was pushed");
}

}  // namespace

void add_reconstructor(py::module_& module) {
    add_frame(module);
    add_iterator(module);
    py::class_<GuardedReconstructor> it(
        module, "Reconstructor",
        "Events in, frames with uncertainty out.\n"
        "\n"
        "model: a name (default, small, thesis) or a file. width, height: the sensor's.\n"
        "window: how events are cut: model, auto, 50ms, 20000ev, 0.35epp.\n"
        "lookahead: windows a frame waits for, 0 to 2.\n"
        "fps: rate of frames() and next(), a number or a text: '30000/1001', 'frame'.\n"
        "size: (width, height) of the frames. roi: (x, y, width, height) of the part wanted.\n"
        "sigma: whether frames have one.\n"
        "hot_pixels: off, learn or a file.\n"
        "noise_filter: model, auto, off or a time: '10ms'.\n"
        "lamp_flicker: auto, off or a time.\n"
        "images: whether the camera's images that are pushed correct frames.\n"
        "self_ensemble: 1, 2 or 4 networks of mirrored views, whose frames' mean is given.\n"
        "precision: auto, f32, bf16. kernels: auto, own, onednn. threads: 0 for all.\n"
        "reset_on_gap: forget the scene where data were lost.\n"
        "allow_silence: any number of frames in a row without events.\n"
        "\n"
        "For recordings window='auto', lookahead=2, lamp_flicker='16ms' are better.");
    it.def(py::init(&make), py::arg("model"), py::arg("width"), py::arg("height"), py::kw_only(),
           py::arg("window") = "model", py::arg("lookahead") = 0, py::arg("fps") = "30",
           py::arg("size") = py::none(), py::arg("roi") = py::none(), py::arg("sigma") = true,
           py::arg("hot_pixels") = "off", py::arg("noise_filter") = "model",
           py::arg("precision") = "auto", py::arg("kernels") = "auto", py::arg("threads") = 0,
           py::arg("reset_on_gap") = false, py::arg("allow_silence") = false,
           py::arg("images") = true, py::arg("lamp_flicker") = "auto",
           py::arg("self_ensemble") = 1);
    add_events_in(it);
    add_state(it);
    add_frames_out(it);
}

}  // namespace eventide::python
