// The pipeline of threads for Python: anything that can be iterated is a source, any callable a
// sink.
#include "python/arrays.h"
#include "python/interruptible_run.h"
#include "python/sources.h"

#include <eventide/error.h>
#include <eventide/pipeline.h>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace eventide::python {

namespace py = pybind11;

namespace {

int size_of(const py::object& source, const char* name, int given) {
    if (given != 0) return given;
    if (py::hasattr(source, name)) return cast_to<int>(name, source.attr(name));
    throw Error(ErrorKind::usage, std::string{"Pipeline: expected a source with a "} + name +
                                      ", or the argument " + name + ", found neither");
}

/// Is told when a run begins and ends, without Python's lock.
class SourceOfRun : public EventSource {
public:
    /// Throws Error (usage) where another run is on, or was.
    virtual void begin() = 0;
    virtual void end() noexcept = 0;
};

/// A Reader or Camera itself, with all that it tells beside its events.
template <typename T>
class WholeSource final : public SourceOfRun {
public:
    /// Without threads run() itself reads: then this is where signals are heard.
    WholeSource(py::object source, int width, int height, bool hears_signals)
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
        if (hears_signals_) check_signals();
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
    static void check_signals() {
        const py::gil_scoped_acquire locked;
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    }

    py::object owner_;
    Source<T>& source_;
    SensorInfo info_;
    const bool hears_signals_;
};

/// Reads on a thread that is none of Python's: everything here takes Python's lock.
class IteratedSource final : public SourceOfRun {
public:
    IteratedSource(py::object source, int width, int height)
        : source_(std::move(source)),
          events_(py::iter(source_)),
          live_(py::hasattr(source_, "gap_before")),
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
        const py::gil_scoped_acquire locked;
        events_ = source_ = {};
    }

    bool read(Batch& batch) override {
        const py::gil_scoped_acquire locked;
        batch.clear();
        gap_before_ = false;
        const auto events =
            py::reinterpret_steal<py::object>(PyIter_Next(events_.ptr()));  // null at the end
        if (PyErr_Occurred() != nullptr) throw py::error_already_set();
        if (py::hasattr(source_, "clock"))
            if (const py::object clock = source_.attr("clock"); !clock.is_none())
                clock_ = from_us(cast_to<std::int64_t>("clock", clock));
        if (!events) return false;
        append_events(cast_to<py::array>("events", events), batch.events);
        gap_before_ = live_ && cast_to<bool>("gap_before", source_.attr("gap_before"));
        return true;
    }

    /// Without Python's lock, which may fail, nothing could be told anyone.
    // NOLINTNEXTLINE(bugprone-exception-escape)
    void stop() noexcept override {
        const py::gil_scoped_acquire locked;
        try {
            if (source_ && py::hasattr(source_, "stop")) source_.attr("stop")();
        } catch (py::error_already_set& error) {
            error.discard_as_unraisable("stop()");
        }
    }

private:
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

std::unique_ptr<SourceOfRun> source_of(const py::object& source, int width, int height,
                                       bool sequential) {
    if (is_itself<EventReader>(source))
        return std::make_unique<WholeSource<EventReader>>(source, width, height, sequential);
    if (is_itself<EventCamera>(source))
        return std::make_unique<WholeSource<EventCamera>>(source, width, height, sequential);
    return std::make_unique<IteratedSource>(source, width, height);
}

/// From here to its end a source is the run's.
class Run {
public:
    explicit Run(SourceOfRun& source) : source_(source) { source_.begin(); }
    ~Run() { source_.end(); }
    Run(const Run&) = delete;
    Run& operator=(const Run&) = delete;

private:
    SourceOfRun& source_;
};

/// Calls with a frame that is the callee's to keep; False ends the run.
class CalledSink final : public FrameSink {
public:
    /// `run`: its caller's thread makes the calls; null: the thread that writes does.
    CalledSink(py::object callable, InterruptibleRun* run)
        : callable_(std::move(callable)), run_(run) {}

    bool write(const Frame& frame) override {
        bool wants_more = true;
        const auto ask = [&] { wants_more = call(frame); };
        run_ != nullptr ? run_->call_there(ask) : ask();
        return wants_more;
    }
    /// Lets go of what may know the pipeline.
    void close() override {
        const py::gil_scoped_acquire locked;
        callable_ = {};
    }

private:
    bool call(const Frame& frame) {
        const py::gil_scoped_acquire locked;
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        return !callable_(std::make_shared<Frame>(frame)).is(py::bool_(false));
    }

    py::object callable_;
    InterruptibleRun* const run_;
};

class PipelineOfPython {
public:
    PipelineOfPython(const py::object& source, const py::object& sinks,
                     const std::filesystem::path& model, int width, int height, double latency,
                     bool sequential, const py::kwargs& options)
        : sequential_(sequential), source_(source_of(source, width, height, sequential)) {
        for (const py::handle sink : py::isinstance<py::sequence>(sinks)
                                         ? py::list(sinks)
                                         : py::list(py::make_tuple(sinks)))
            sinks_.push_back(std::make_unique<CalledSink>(py::reinterpret_borrow<py::object>(sink),
                                                          sequential ? nullptr : &interruptible_));
        std::vector<FrameSink*> all;
        for (const auto& sink : sinks_) all.push_back(sink.get());
        if (!(latency >= 0 && latency <= 1e6))
            throw Error(ErrorKind::usage,
                        "latency: expected 0 to 1000000 s, found " + std::to_string(latency));
        PipelineOptions how;
        how.frames = options_of(options);
        how.latency = std::chrono::microseconds{std::llround(1e6 * latency)};
        how.sequential = sequential;
        const py::gil_scoped_release released;
        pipeline_ = std::make_unique<EventPipeline>(*source_, all, model.string(), how);
    }

    /// Sinks are called here, and signals heard: the library's part of it has a thread of its own.
    void run() {
        const py::gil_scoped_release released;
        const Run run{*source_};
        if (sequential_) return pipeline_->run();
        interruptible_.run([this] { pipeline_->run(); }, [this] { pipeline_->stop(); });
    }
    void stop() {
        const py::gil_scoped_release released;
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
                {"latency_p50_us", std::uint64_t(c.latency_p50.count())},
                {"latency_p99_us", std::uint64_t(c.latency_p99.count())}};
    }

private:
    const bool sequential_;
    InterruptibleRun interruptible_;
    std::unique_ptr<SourceOfRun> source_;
    std::vector<std::unique_ptr<CalledSink>> sinks_;
    std::unique_ptr<EventPipeline> pipeline_;
};

}  // namespace

void add_pipeline(py::module_& module) {
    py::class_<PipelineOfPython>(
        module, "Pipeline",
        "Reading, cutting, encoding and rendering on a thread each.\n\n"
        "source: a Reader, a Camera, or anything that gives structured arrays of events when it "
        "is\n"
        "iterated; width and height where it does not have them. It may have what a Camera has:\n"
        "clock (us, or None), gap_before (then it is live, and what is late is left out), stop().\n"
        "Nobody else may read a Reader or Camera until run() is over. sinks: a callable, or a list "
        "of\n"
        "them, each called with every Frame on the thread of run(); False ends the run.\n"
        "latency: of a Camera, seconds, what a frame may be late at most; 0: anything.\n"
        "Other options are those of Reconstructor.")
        .def(py::init<const py::object&, const py::object&, const std::filesystem::path&, int, int,
                      double, bool, const py::kwargs&>(),
             py::arg("source"), py::arg("sinks"), py::arg("model") = "default", py::kw_only(),
             py::arg("width") = 0, py::arg("height") = 0, py::arg("latency") = 0.25,
             py::arg("sequential") = false)
        .def("run", &PipelineOfPython::run,
             "Until the source has ended, a sink returns False, or stop(); once. What a source or "
             "sink raises comes out of it.")
        .def("stop", &PipelineOfPython::stop, "From any thread: what was read is still finished.")
        .def_property_readonly("counters", &PipelineOfPython::counters, "so far");
}

}  // namespace eventide::python
