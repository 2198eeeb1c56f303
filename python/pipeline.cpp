// The pipeline of threads for Python: anything that can be iterated is a source, any callable a
// sink.
#include "python/interruptible_run.h"
#include "python/lock.h"
#include "python/parts.h"
#include "python/run_source.h"
#include "python/signals.h"

#include <eventide/error.h>
#include <eventide/pipeline.h>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace eventide::python {

namespace py = pybind11;

namespace {

/// From here to its end a source is the run's.
class Run {
public:
    explicit Run(RunSource& source) : source_(source) { source_.begin(); }
    ~Run() { source_.end(); }
    Run(const Run&) = delete;
    Run& operator=(const Run&) = delete;

private:
    RunSource& source_;
};

/// Calls with a frame that is the callee's to keep; False ends the run.
class CalledSink final : public FrameSink {
public:
    /// `run`: its caller's thread makes the calls; null: the thread that writes does.
    CalledSink(py::object callable, InterruptibleRun* run)
        : callable_(std::move(callable)), run_(run) {}

    bool write(const Frame& frame) override {
        bool wants_more = true;
        const auto ask = [&] { wants_more = with_lock([&] { return call(frame); }); };
        run_ != nullptr ? run_->call_there(ask) : ask();
        return wants_more;
    }
    /// Lets go of what may know the pipeline.
    void close() override {
        with_lock([this] { clear(); });
    }
    /// With Python's lock.
    PyObject* callable() const { return callable_.ptr(); }
    void clear() { callable_ = {}; }

private:
    bool call(const Frame& frame) {
        check_signals();
        const py::object shown = py::cast(std::make_shared<Frame>(frame));
        const auto answer = py::reinterpret_steal<py::object>(
            or_stay([&] { return PyObject_CallOneArg(callable_.ptr(), shown.ptr()); }));
        if (!answer) throw py::error_already_set();
        py::detail::make_caster<bool> said;  // without conversion: True, False, or one of NumPy's
        return !said.load(answer, false) || bool(said);
    }

    py::object callable_;
    InterruptibleRun* const run_;
};

class PipelineOfPython {
public:
    PipelineOfPython(const py::object& source, const py::object& sinks,
                     const std::filesystem::path& model, int width, int height, double latency,
                     bool sequential, const py::kwargs& options)
        : sequential_(sequential), source_(run_source(source, width, height, sequential)) {
        const bool is_list =
            PyCallable_Check(sinks.ptr()) == 0 && py::isinstance<py::sequence>(sinks);
        for (const py::handle sink : is_list ? py::list(sinks) : py::list(py::make_tuple(sinks))) {
            if (PyCallable_Check(sink.ptr()) == 0)
                throw py::type_error("sinks: expected a callable, or a list of them, found " +
                                     py::repr(sink).cast<std::string>());
            sinks_.push_back(std::make_unique<CalledSink>(py::reinterpret_borrow<py::object>(sink),
                                                          sequential ? nullptr : &interruptible_));
        }
        std::vector<FrameSink*> all;
        for (const auto& sink : sinks_) all.push_back(sink.get());
        if (!(latency >= 0 && latency <= 1e6))
            throw Error(ErrorKind::usage,
                        "latency: expected 0 to 1000000 s, found " + std::to_string(latency));
        PipelineOptions how;
        how.frames = options_of(options);
        how.latency = std::chrono::microseconds{std::llround(1e6 * latency)};
        how.sequential = sequential;
        const Unlocked unlocked;
        pipeline_ = std::make_unique<EventPipeline>(*source_, all, model.string(), how);
    }

    /// Sinks are called here, and signals heard: the library's part of it has a thread of its own.
    void run() {
        const Unlocked unlocked;
        const Run run{*source_};
        if (sequential_) return pipeline_->run();
        interruptible_.run([this] { pipeline_->run(); }, [this] { pipeline_->stop(); });
    }
    void stop() {
        const Unlocked unlocked;
        pipeline_->stop();
    }
    std::map<std::string, std::uint64_t> counters() const {
        const PipelineCounters c = pipeline_->counters();
        return {{"batches", c.batches},
                {"lost_batches", c.lost_batches},
                {"gaps", c.gaps},
                {"events", c.events},
                {"filtered", c.filtered},
                {"damaged", c.damaged},
                {"event_windows", c.event_windows},
                {"merged_windows", c.merged_windows},
                {"frames", c.frames},
                {"skipped_frames", c.skipped_frames},
                {"used_images", c.used_images},
                {"dropped_images", c.dropped_images},
                {"latency_p50_us", std::uint64_t(c.latency_p50.count())},
                {"latency_p99_us", std::uint64_t(c.latency_p99.count())}};
    }

    /// What may know the pipeline, for Python's collector of circles.
    int visit(const std::function<int(PyObject*)>& visit) const {
        for (const auto& sink : sinks_)
            if (const int stopped = visit(sink->callable())) return stopped;
        return source_->visit(visit);
    }
    /// Of one that nobody can reach: it does not run.
    void clear() {
        for (const auto& sink : sinks_) sink->clear();
        source_->clear();
    }

private:
    const bool sequential_;
    InterruptibleRun interruptible_;
    std::unique_ptr<RunSource> source_;
    std::vector<std::unique_ptr<CalledSink>> sinks_;
    std::unique_ptr<EventPipeline> pipeline_;
};

/// Null while Python makes or destroys it.
PipelineOfPython* pipeline_of(PyObject* self) {
    const auto held = reinterpret_cast<py::detail::instance*>(self)->get_value_and_holder();
    return held.holder_constructed() ? held.value_ptr<PipelineOfPython>() : nullptr;
}

int traverse(PyObject* self, visitproc visit, void* arg) {
    Py_VISIT(Py_TYPE(self));
    const PipelineOfPython* pipeline = pipeline_of(self);
    if (pipeline == nullptr) return 0;
    return pipeline->visit(
        [&](PyObject* object) { return object != nullptr ? visit(object, arg) : 0; });
}

int clear(PyObject* self) {
    if (PipelineOfPython* pipeline = pipeline_of(self)) pipeline->clear();
    return 0;
}

/// A sink is often a method of the object that owns the pipeline.
void be_collected(PyHeapTypeObject* made) {
    PyTypeObject& type = made->ht_type;
    type.tp_flags |= Py_TPFLAGS_HAVE_GC;
    type.tp_traverse = traverse;
    type.tp_clear = clear;
}

}  // namespace

void add_pipeline(py::module_& module) {
    py::class_<PipelineOfPython>(
        module, "Pipeline", py::custom_type_setup(be_collected),
        "Reading, cutting, encoding and rendering on a thread each.\n"
        "\n"
        "source: a Reader, a Camera, or anything that gives structured arrays of events\n"
        "when it is iterated. It may have what a Camera has: clock (us, or None),\n"
        "gap_before (then it is live, and what is late is left out), stop(). Nobody else\n"
        "may read a Reader or Camera until run() is over.\n"
        "width, height: of a source that does not have them.\n"
        "sinks: a callable, or a list of them, each called with every Frame on the thread\n"
        "of run(); False ends the run.\n"
        "latency: of a Camera, seconds, what a frame may be late at most; 0: anything.\n"
        "sequential: everything on the thread of run().\n"
        "\n"
        "Other options are those of Reconstructor.")
        .def(py::init<const py::object&, const py::object&, const std::filesystem::path&, int, int,
                      double, bool, const py::kwargs&>(),
             py::arg("source"), py::arg("sinks"), py::arg("model") = "default", py::kw_only(),
             py::arg("width") = 0, py::arg("height") = 0, py::arg("latency") = 0.25,
             py::arg("sequential") = false)
        .def("run", &PipelineOfPython::run,
             "Until the source has ended, a sink returns False, or stop(); once. What a source or "
             "sink raises comes out of it. A source that waits longer than that is left behind.")
        .def("stop", &PipelineOfPython::stop, "From any thread: what was read is still finished.")
        .def_property_readonly("counters", &PipelineOfPython::counters, "so far");
}

}  // namespace eventide::python
