// Recordings and cameras for Python.
#include "python/sources.h"

#include "python/arrays.h"
#include "python/messages.h"
#include "python/signals.h"

#include <eventide/error.h>
#include <eventide/pipeline.h>
#include <eventide/writer.h>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

namespace eventide::python {

namespace py = pybind11;

namespace {

template <typename T>
void check_free(const Source<T>& source) {
    if (source.running)
        throw Error(ErrorKind::usage,
                    "source: expected one that nothing else reads, found one that a Pipeline runs "
                    "on");
}

/// The next batch. What came beside events stays until they were handed out.
template <typename T>
bool read_batch(Source<T>& source) {
    check_free(source);
    if (std::exchange(source.handed_out, false)) {
        source.images.clear();
        source.gap_before = false;
    }
    const bool more = source.it.read(source.batch);
    source.gap_before = source.gap_before || (more && source.it.gap_before());
    return more;
}

/// Of readers alone: a camera may go on for ever without events.
template <typename T>
void keep_images(Source<T>& source) {
    if constexpr (std::is_same_v<T, EventReader>)
        std::ranges::move(source.batch.images, std::back_inserter(source.images));
}

/// Batches without events are passed over, and their images and gaps are those of the next.
template <typename T>
py::array next(Source<T>& source) {
    for (;;) {
        check_signals();
        std::vector<Event> events;
        const bool more = source.with([&](T&) {
            const bool read = read_batch(source);
            keep_images(source);
            std::swap(events, source.batch.events);
            source.handed_out = !read || !events.empty();
            return read;
        });
        if (!more) throw py::stop_iteration();
        if (!events.empty()) return array_of(std::move(events));
    }
}

template <typename T>
bool read_into(Source<T>& source, GuardedReconstructor& reconstructor) {
    check_signals();
    return source.with([&](T& it) {
        refuse_other_sensor(it, reconstructor.it);
        const bool more = read_batch(source);
        source.handed_out = true;
        if (!more) return false;
        const std::lock_guard lock{reconstructor.mutex};
        push_from(it, source.batch, reconstructor.it);
        keep_images(source);
        return true;
    });
}

py::list images(Source<EventReader>& source) {
    const auto now = source.with([&](EventReader&) { return source.images; });
    py::list all;
    for (const ReferenceImage& image : now)
        all.append(py::make_tuple(to_us(image.t), array_of(image)));
    return all;
}

/// What both have.
template <typename T>
py::class_<Source<T>> add_source(py::module_& module, const char* name, const char* meaning) {
    py::class_<Source<T>> made(module, name, meaning);
    made.def("__iter__", [](const py::object& self) { return self; })
        .def("__next__", &next<T>)
        .def("read_into", &read_into<T>, py::arg("reconstructor"),
             "Reads on and pushes what came, with images and marks of lost data; False at "
             "the end.")
        .def(
            "add_filter",
            [](Source<T>& s, const std::string& filter) {
                s.with([&](T& it) {
                    check_free(s);
                    it.add_filter(filter);
                });
            },
            py::arg("filter"),
            "Puts a filter behind it before anything is read: \"flicker\", as eventide run "
            "--filter.")
        .def_property_readonly(
            "width", [](Source<T>& s) { return s.it.width(); },
            "px, of the sensor behind its filters")
        .def_property_readonly(
            "height", [](Source<T>& s) { return s.it.height(); },
            "px, of the sensor behind its filters")
        .def_property_readonly(
            "format", [](Source<T>& s) { return s.it.info().format; }, "aedat4, evt3, davis, ...")
        .def_property_readonly(
            "sensor", [](Source<T>& s) { return s.it.info().name; }, "its name; may be empty")
        .def_property_readonly(
            "clock", [](Source<T>& s) { return us_of(s.look([&](T&) { return s.told().clock; })); },
            "us, the newest time told so far, or None")
        .def_property_readonly(
            "damaged", [](Source<T>& s) { return s.look([&](T&) { return s.told().damaged; }); },
            "places where bytes made no sense, so far");
    return made;
}

void add_reader(py::module_& module) {
    add_source<EventReader>(
        module, "Reader",
        "A recording; iterate it for structured arrays (t, x, y, on). What had to "
        "be guessed is logged, too, as warnings of the logger \"eventide\".")
        .def(py::init([](const std::filesystem::path& path, std::string format, int width,
                         int height, std::string stream) {
                 const Unlocked unlocked;
                 return std::make_unique<Source<EventReader>>(
                     path.string(), ReaderOptions{std::move(format), width, height, hear_signals,
                                                  log_warning, std::move(stream)});
             }),
             py::arg("path"), py::arg("format") = "", py::arg("width") = 0, py::arg("height") = 0,
             py::arg("stream") = "")
        .def_property_readonly(
            "remarks", [](Source<EventReader>& s) { return s.it.remarks(); },
            "what had to be guessed: sentences")
        .def_property_readonly(
            "images", &images,
            "(t, uint16 array) of each image that came with the newest events or "
            "between them and those before; at the end, after the last events")
        .def(
            "seek",
            [](Source<EventReader>& s, std::int64_t t) {
                s.with([&](EventReader& it) {
                    check_free(s);
                    s.handed_out = true;
                    it.seek(from_us(t));
                });
            },
            py::arg("t"),
            "Goes on from t (us) with the first event and image from then on. A Reconstructor that "
            "saw others wants reset() first. Does nothing on standard input and on pipes.")
        .def(
            "span",
            [](Source<EventReader>& s) -> py::object {
                const auto span = s.with([](EventReader& it) { return it.span(); });
                if (!span) return py::none();
                return py::make_tuple(to_us(span->begin), to_us(span->end));
            },
            "us, times of the first and last event, or None; reads all of it.");
}

void add_camera(py::module_& module) {
    add_source<EventCamera>(
        module, "Camera",
        "A camera; iterate it for structured arrays (t, x, y, on). Why one was "
        "passed over, or is waited for, are warnings of the logger \"eventide\".")
        .def(py::init([](const std::string& name, const std::filesystem::path& settings,
                         bool reconnect) {
                 const Unlocked unlocked;
                 return std::make_unique<Source<EventCamera>>(
                     name, CameraSettings{settings, reconnect, hear_signals, log_warning});
             }),
             py::arg("name"), py::arg("settings") = "", py::arg("reconnect") = false)
        .def_property_readonly(
            "gap_before",
            [](Source<EventCamera>& s) {
                return s.with([&](EventCamera&) { return s.gap_before; });
            },
            "whether data were lost between the newest events and those before")
        .def(
            "stop", [](Source<EventCamera>& s) { s.it.stop(); },
            "From any thread: iteration ends soon.");
}

/// None once a with block was left by an exception.
struct GuardedWriter : Guarded<std::optional<EventWriter>> {
    using Guarded::Guarded;

    template <typename Body>
    void with_open(Body body) {
        with([&](std::optional<EventWriter>& writer) {
            if (!writer)
                throw Error(ErrorKind::usage,
                            "expected a recording that is being written, found one that was given "
                            "up");
            body(*writer);
        });
    }
};

void add_writer(py::module_& module) {
    const auto finish = [](GuardedWriter& w) { w.with_open([](EventWriter& it) { it.finish(); }); };
    py::class_<GuardedWriter>(module, "Writer",
                              "A recording being written; it appears whole, with finish() or at "
                              "the end of a with block. Of one left by an exception nothing stays.")
        .def(py::init([](const std::filesystem::path& path, int width, int height,
                         std::string format, bool overwrite) {
                 const Unlocked unlocked;
                 return std::make_unique<GuardedWriter>(
                     std::in_place, path.string(), SensorInfo{"", "", "", width, height},
                     WriterOptions{std::move(format), overwrite, hear_signals});
             }),
             py::arg("path"), py::arg("width"), py::arg("height"), py::arg("format") = "",
             py::arg("overwrite") = false)
        .def(
            "write",
            [](GuardedWriter& w, const py::array& events) {
                std::vector<Event> all;
                append_events(events, all);
                w.with_open([&](EventWriter& it) { it.write(std::span<const Event>{all}); });
            },
            py::arg("events"), "Events in order of time, which follow the ones before.")
        .def("finish", finish, "Ends the recording and shows the file.")
        .def("__enter__", [](const py::object& self) { return self; })
        .def("__exit__", [finish](GuardedWriter& w, const py::object& type, const py::object&,
                                  const py::object&) {
            if (type.is_none()) return finish(w);
            w.with([](std::optional<EventWriter>& it) { it.reset(); });
        });
}

}  // namespace

void add_sources(py::module_& module) {
    add_reader(module);
    add_camera(module);
    add_writer(module);
}

}  // namespace eventide::python
