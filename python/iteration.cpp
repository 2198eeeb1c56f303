#include "python/iteration.h"

#include "python/arrays.h"
#include "python/lock.h"
#include "python/parts.h"

#include <pybind11/stl.h>

#include <cstdint>
#include <utility>
#include <vector>

namespace eventide::python {

namespace py = pybind11;

py::object attribute_of(const py::object& source, const char* name) {
    if (PyObject* found = PyObject_GetAttrString(source.ptr(), name))
        return py::reinterpret_steal<py::object>(found);
    if (PyErr_ExceptionMatches(PyExc_AttributeError) == 0) throw py::error_already_set();
    PyErr_Clear();
    return py::none();
}

namespace {

/// As Reader.images gives them.
void append_images(const py::object& images, std::vector<ReferenceImage>& into) {
    using TimeAndPixels = std::pair<std::int64_t, py::array>;
    for (const auto& [t, pixels] : cast_to<std::vector<TimeAndPixels>>("images", images)) {
        ReferenceImage& image = into.emplace_back(image_of(pixels));
        image.t = image.exposure_begin = image.exposure_end = from_us(t);
    }
}

}  // namespace

Iteration::Iteration(const py::object& source)
    : source_(source),
      events_(py::iter(source_)),
      live_(!attribute_of(source_, "gap_before").is_none()) {}

Iteration::~Iteration() {
    with_lock([this] { events_ = source_ = {}; });
}

Answer Iteration::next() noexcept {
    return with_lock([this] {
        Answer answer;
        asks_ = PyThread_get_thread_ident();
        try {
            ask(answer);
        } catch (const std::exception&) {
            answer.error = std::current_exception();
        }
        asks_ = 0;
        return answer;
    });
}

void Iteration::ask(Answer& answer) {
    const auto events = py::reinterpret_steal<py::object>(
        or_stay([&] { return PyIter_Next(events_.ptr()); }));  // null at the end
    if (PyErr_Occurred() != nullptr) throw py::error_already_set();
    if (const py::object clock = attribute_of(source_, "clock"); !clock.is_none())
        answer.clock = from_us(cast_to<std::int64_t>("clock", clock));
    if (!events) return;
    append_events(cast_to<py::array>("events", events), answer.batch.events);
    if (const py::object images = attribute_of(source_, "images"); !images.is_none())
        append_images(images, answer.batch.images);
    answer.gap_before = live_ && cast_to<bool>("gap_before", source_.attr("gap_before"));
    answer.more = true;
}

void Iteration::stop() {
    try {
        if (const py::object stop = attribute_of(source_, "stop"); !stop.is_none()) stop();
    } catch (py::error_already_set& error) {
        error.discard_as_unraisable("stop()");
    }
}

void Iteration::give_up() {
    with_lock([this] {
        if (asks_ != 0) PyThreadState_SetAsyncExc(asks_, PyExc_GeneratorExit);
    });
}

}  // namespace eventide::python
