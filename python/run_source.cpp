// Sources of the library and of Python for a Pipeline.
#include "python/run_source.h"

#include "python/aside.h"
#include "python/iteration.h"
#include "python/lock.h"
#include "python/parts.h"
#include "python/signals.h"
#include "python/sources.h"

#include <eventide/error.h>

#include <atomic>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

namespace eventide::python {

namespace py = pybind11;

namespace {

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
    int visit(const std::function<int(PyObject*)>& visit) const override {
        return visit(owner_.ptr());
    }
    void clear() override {}  // it is what is read: others in the circle let go

private:
    py::object owner_;
    Source<T>& source_;
    SensorInfo info_;
    const bool hears_signals_;
};

/// Asks the iterator on a thread of its own, where `aside`: one that waits for ever is left behind
/// then. Without, run() reads on Python's main thread, where signals are heard.
class IteratedSource final : public RunSource {
public:
    IteratedSource(const py::object& source, int width, int height, bool aside)
        : iteration_(std::make_shared<Iteration>(source)),
          live_(iteration_->is_live()),
          info_{.name = "python",
                .serial = "",
                .format = "",
                .width = size_of(source, "width", width),
                .height = size_of(source, "height", height)} {
        if (aside) aside_.emplace();
    }

    const SensorInfo& info() const noexcept override { return info_; }
    bool is_live() const noexcept override { return live_; }
    bool gap_before() const noexcept override { return gap_before_; }
    std::optional<SensorTime> clock() const override { return clock_; }

    void begin() override {
        if (begun_.exchange(true))
            throw Error(ErrorKind::usage,
                        "pipeline: expected one run, found a second; make another pipeline");
    }
    /// Lets go of what may know the pipeline.
    // NOLINTNEXTLINE(bugprone-exception-escape): as in stop().
    void end() noexcept override {
        with_lock([this] { iteration_.reset(); });
    }

    int visit(const std::function<int(PyObject*)>& visit) const override {
        return iteration_ ? iteration_->visit(visit) : 0;
    }
    void clear() override { iteration_.reset(); }

    bool read(Batch& batch) override {
        batch.clear();
        gap_before_ = false;
        const auto answer = std::make_shared<Answer>();
        const auto ask = [iteration = iteration_, answer] { *answer = iteration->next(); };
        if (!aside_) {
            hear_signals();
            ask();
        } else if (!aside_->run(ask)) {
            iteration_->give_up();
            return false;
        }
        if (answer->error) std::rethrow_exception(answer->error);
        if (answer->clock) clock_ = answer->clock;
        gap_before_ = answer->gap_before;
        std::swap(batch, answer->batch);
        return answer->more;
    }

    /// Without Python's lock, which may fail, nothing could be told anyone.
    // NOLINTNEXTLINE(bugprone-exception-escape)
    void stop() noexcept override {
        with_lock([this] {
            if (const auto iteration = iteration_) iteration->stop();
        });
        if (aside_) aside_->hurry();
    }

private:
    std::shared_ptr<Iteration> iteration_;  // by Python's lock, until end()
    const bool live_;
    const SensorInfo info_;
    bool gap_before_ = false;
    std::optional<SensorTime> clock_;
    std::atomic<bool> begun_{false};
    std::optional<Aside> aside_;
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
    return std::make_unique<IteratedSource>(source, width, height, !sequential);
}

}  // namespace eventide::python
