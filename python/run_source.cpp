// Sources of the library and of Python for a Pipeline.
#include "python/run_source.h"

#include "python/arrays.h"
#include "python/lock.h"
#include "python/parts.h"
#include "python/signals.h"
#include "python/sources.h"

#include <eventide/error.h>

#include <pybind11/stl.h>

#include <atomic>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace eventide::python {

namespace py = pybind11;

namespace {

/// None where there is none. Asked for once, as a property may give what is new only once; what it
/// raises comes out.
py::object attribute_of(const py::object& source, const char* name) {
    if (PyObject* found = PyObject_GetAttrString(source.ptr(), name))
        return py::reinterpret_steal<py::object>(found);
    if (PyErr_ExceptionMatches(PyExc_AttributeError) == 0) throw py::error_already_set();
    PyErr_Clear();
    return py::none();
}

int size_of(const py::object& source, const char* name, int given) {
    if (given != 0) return given;
    if (const py::object size = attribute_of(source, name); !size.is_none())
        return cast_to<int>(name, size);
    throw Error(ErrorKind::usage, std::string{"Pipeline: expected a source with a "} + name +
                                      ", or the argument " + name + ", found neither");
}

/// A Reader or Camera itself, with all that it tells beside its events.
template <typename T>
class LibrarySource final : public RunSource {
public:
    /// Without threads run() itself reads: then this is where signals are heard.
    LibrarySource(py::object source, int width, int height, bool hears_signals)
        : owner_(std::move(source)),
          source_(owner_.cast<Source<T>&>()),
          info_(source_.it.info()),
          hears_signals_(hears_signals) {
        if (width != 0) info_.width = width;
        if (height != 0) info_.height = height;
    }

    const SensorInfo& info() const noexcept override { return info_; }
    bool is_live() const noexcept override { return source_.it.is_live(); }
    bool gap_before() const noexcept override { return source_.it.gap_before(); }
    std::optional<SensorTime> clock() const override { return source_.it.clock(); }
    void stop() noexcept override { source_.it.stop(); }

    bool read(Batch& batch) override {
        if (hears_signals_) hear_signals();
        const bool more = source_.it.read(batch);
        const std::lock_guard lock{source_.mutex};
        source_.running = source_.now();
        return more;
    }

    void begin() override {
        const std::lock_guard lock{source_.mutex};
        if (source_.running)
            throw Error(ErrorKind::usage,
                        "Pipeline: expected a source of its own, found one that another runs on");
        source_.running = source_.now();
        source_.handed_out = true;
    }
    void end() noexcept override {
        const std::lock_guard lock{source_.mutex};
        source_.running.reset();
    }

private:
    py::object owner_;
    Source<T>& source_;
    SensorInfo info_;
    const bool hears_signals_;
};

/// Reads on a thread that is none of Python's: everything here takes Python's lock.
class IteratedSource final : public RunSource {
public:
    IteratedSource(py::object source, int width, int height)
        : source_(std::move(source)),
          events_(py::iter(source_)),
          live_(!attribute_of(source_, "gap_before").is_none()),
          info_{.name = "python",
                .serial = "",
                .format = "",
                .width = size_of(source_, "width", width),
                .height = size_of(source_, "height", height)} {}

    const SensorInfo& info() const noexcept override { return info_; }
    bool is_live() const noexcept override { return live_; }
    bool gap_before() const noexcept override { return gap_before_; }
    std::optional<SensorTime> clock() const override { return clock_; }

    void begin() override {
        if (begun_.exchange(true))
            throw Error(ErrorKind::usage,
                        "pipeline: expected one run, found a second; make another pipeline");
    }
    /// Lets go of what may know the pipeline: Python does not see such a circle.
    // NOLINTNEXTLINE(bugprone-exception-escape): as in stop().
    void end() noexcept override {
        with_lock([this] { events_ = source_ = {}; });
    }

    bool read(Batch& batch) override {
        batch.clear();
        gap_before_ = false;
        return with_lock([&] { return read_on(batch); });
    }

    /// Without Python's lock, which may fail, nothing could be told anyone.
    // NOLINTNEXTLINE(bugprone-exception-escape)
    void stop() noexcept override {
        with_lock([this] { ask_to_stop(); });
    }

private:
    /// With Python's lock, as all below.
    bool read_on(Batch& batch) {
        const auto events = py::reinterpret_steal<py::object>(
            or_stay([&] { return PyIter_Next(events_.ptr()); }));  // null at the end
        if (PyErr_Occurred() != nullptr) throw py::error_already_set();
        if (const py::object clock = attribute_of(source_, "clock"); !clock.is_none())
            clock_ = from_us(cast_to<std::int64_t>("clock", clock));
        if (!events) return false;
        append_events(cast_to<py::array>("events", events), batch.events);
        if (const py::object images = attribute_of(source_, "images"); !images.is_none())
            append_images(images, batch.images);
        gap_before_ = live_ && cast_to<bool>("gap_before", source_.attr("gap_before"));
        return true;
    }

    void ask_to_stop() {
        try {
            if (!source_) return;
            if (const py::object stop = attribute_of(source_, "stop"); !stop.is_none()) stop();
        } catch (py::error_already_set& error) {
            error.discard_as_unraisable("stop()");
        }
    }

    /// As Reader.images gives them.
    static void append_images(const py::object& images, std::vector<ReferenceImage>& into) {
        using TimeAndPixels = std::pair<std::int64_t, py::array>;
        for (const auto& [t, pixels] : cast_to<std::vector<TimeAndPixels>>("images", images)) {
            ReferenceImage& image = into.emplace_back(image_of(pixels));
            image.t = image.exposure_begin = image.exposure_end = from_us(t);
        }
    }

    py::object source_;
    py::object events_;
    const bool live_;
    const SensorInfo info_;
    bool gap_before_ = false;
    std::optional<SensorTime> clock_;
    std::atomic<bool> begun_{false};
};

/// Of a class derived from T in Python the iterator may be another, and is what is meant.
template <typename T>
bool is_itself(const py::object& source) {
    return py::type::of(source).is(py::type::of<Source<T>>());
}

}  // namespace

std::unique_ptr<RunSource> run_source(const py::object& source, int width, int height,
                                      bool sequential) {
    if (is_itself<EventReader>(source))
        return std::make_unique<LibrarySource<EventReader>>(source, width, height, sequential);
    if (is_itself<EventCamera>(source))
        return std::make_unique<LibrarySource<EventCamera>>(source, width, height, sequential);
    return std::make_unique<IteratedSource>(source, width, height);
}

}  // namespace eventide::python
