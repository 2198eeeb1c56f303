/// @file
/// A source, a network and sinks in a run: what `eventide run` does, with sources and sinks of
/// yours.
#pragma once

#include <eventide/event.h>
#include <eventide/frame.h>
#include <eventide/reconstructor.h>
#include <eventide/version.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace eventide {

/// Where events come from: an EventReader, an EventCamera, or one of your own. Thread: one at a
/// time, stop() excepted.
class EVENTIDE_API EventSource {
public:
    virtual ~EventSource();

    /// Width and height are known and stay.
    virtual const SensorInfo& info() const noexcept = 0;

    /// The next data in place of what `batch` held, which may be none. An event earlier than the
    /// one before it means that the sensor's clock was reset. False at the end, and after stop().
    /// What it throws ends the run and comes out of it.
    virtual bool read(Batch& batch) = 0;

    /// Every event before this time has been read, where that is known: frames of a live source go
    /// on by it while nothing moves. At the end of a recording: until when it lasted. One further
    /// from zero than Reconstructor::kFarthestTime ends a run with Error (usage).
    virtual std::optional<SensorTime> clock() const { return std::nullopt; }

    /// Whether data were lost before the newest batch.
    virtual bool gap_before() const noexcept { return false; }

    /// Whether it goes on by itself, and may not be made to wait: read() returns within some 20 ms.
    virtual bool is_live() const noexcept { return false; }

    /// Thread: any. A read() that waits returns false soon.
    virtual void stop() noexcept {}

protected:
    EventSource() = default;
    EventSource(const EventSource&) = default;             ///< yours may be copied
    EventSource& operator=(const EventSource&) = default;  ///< yours may be copied
};

/// Throws Error (usage) where the source's sensor has another size than the reconstructor's: to be
/// called before the source is read, as what was read is gone.
EVENTIDE_API void refuse_other_sensor(const EventSource& source,
                                      const Reconstructor& reconstructor);

/// Pushes what `source` has just read into `batch`: the gap before it, where data were lost, its
/// events and images, and a live source's clock. Throws what Reconstructor::push() throws, and
/// refuse_other_sensor().
EVENTIDE_API void push_from(const EventSource& source, const Batch& batch,
                            Reconstructor& reconstructor);

/// The next frame of a source: reads on until it is there, with push_from() for each batch, and
/// finishes where the source has ended. False after the last frame. Throws
/// what `source` throws, push_from() and Reconstructor::next().
EVENTIDE_API bool read_frame(EventSource& source, Reconstructor& reconstructor, Frame& frame);

/// Where frames go: one of your own. Thread: the one that run() was called on.
class EVENTIDE_API FrameSink {
public:
    virtual ~FrameSink();

    /// Looks at a frame and keeps nothing of it. False: no more are wanted, and the run ends. What
    /// it throws ends the run and comes out of it.
    virtual bool write(const Frame& frame) = 0;

    /// Once, after the last frame, also after an error.
    virtual void close() {}

protected:
    FrameSink() = default;
    FrameSink(const FrameSink&) = default;             ///< yours may be copied
    FrameSink& operator=(const FrameSink&) = default;  ///< yours may be copied
};

/// Which frames a run makes, how late they may be, and on how many threads.
struct PipelineOptions {
    /// As in Reconstructor. `threads` are the network's; the pipeline has four of its own.
    ReconstructorOptions frames{};
    /// For a live source: work is left out, and counted, so that frames are no later than this, at
    /// most 10^6 s; 0: only what the buffers have no room for. Any other source waits.
    std::chrono::microseconds latency{250'000};
    bool sequential = false;  ///< all on the caller's thread; the frames are the same
};

/// So far.
struct PipelineCounters {
    std::uint64_t batches = 0;       ///< read
    std::uint64_t lost_batches = 0;  ///< of those, lost as no buffer was free
    std::uint64_t gaps = 0;          ///< places where data are missing
    std::uint64_t events = 0;        ///< taken, before filters
    std::uint64_t filtered = 0;      ///< of hot pixels, or noise
    std::uint64_t damaged = 0;  ///< events outside the sensor, or at a time beyond kFarthestTime
    std::uint64_t event_windows = 0;   ///< steps of the network
    std::uint64_t merged_windows = 0;  ///< became one with the one before, to keep the latency
    std::uint64_t frames = 0;          ///< written
    std::uint64_t skipped_frames = 0;  ///< of the clock, too late for the latency
    std::uint64_t used_images = 0;     ///< of the camera, corrected frames
    std::uint64_t dropped_images = 0;  ///< came too late for it, or were too many
    std::chrono::microseconds latency_p50{0};  ///< from read() to write(), median
    std::chrono::microseconds latency_p99{0};  ///< from read() to write(), 99th percentile
};

/// Reading, cutting, encoding and rendering on a thread each, with bounded memory in between. Made
/// once for each run. With the same model, window, lookahead, precision and kernels (not automatic
/// ones) the frames of a recording are those of Reconstructor and of `eventide run`, bit for bit.
class EVENTIDE_API EventPipeline {
public:
    /// Source and sinks are borrowed until after run(). Throws Error: usage for a source without a
    /// size, options out of range and a null sink; input where the model cannot be used.
    EventPipeline(EventSource& source, const std::vector<FrameSink*>& sinks,
                  const std::string& model, const PipelineOptions& options = {});
    ~EventPipeline();
    EventPipeline(EventPipeline&&) noexcept;             ///< leaves the other empty
    EventPipeline& operator=(EventPipeline&&) noexcept;  ///< leaves the other empty

    /// Until the source has ended, a sink wants no more, or stop(). The first error of any thread
    /// is thrown, after the sinks were closed. Throws Error (usage) the second time.
    void run();

    /// Thread: any. What has been read is still finished, for at most about a second.
    void stop() noexcept;

    /// Thread: any.
    PipelineCounters counters() const;

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace eventide
