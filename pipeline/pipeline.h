// The pipeline: bytes -> events -> grids -> latent maps -> frames, on four threads or on one.
#pragma once

#include "pipeline/counters.h"
#include "pipeline/event_windows.h"
#include "pipeline/first_error.h"
#include "pipeline/frame_clock.h"
#include "pipeline/frame_output.h"
#include "pipeline/link.h"
#include "pipeline/pace/latency_keeper.h"
#include "pipeline/pace/window_merger.h"
#include "pipeline/pipeline_state.h"
#include "pipeline/pool.h"
#include "pipeline/sink.h"
#include "pipeline/source.h"
#include "pipeline/stages.h"
#include "pipeline/stop_request.h"
#include "src/binning/binner.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <thread>
#include <vector>

namespace eventide {

/// More buffers bridge longer bursts, take more memory and allow more latency: this is the choice
/// between them.
struct PipelineBuffers {
    std::size_t packets = 64, grids = 3, latents = 4;  ///< each at least 1
};

/// For a recording, which waits: it needs no more than one being filled and one being read, and of
/// the small packets a few.
inline constexpr PipelineBuffers kBuffersOfRecording{.packets = 8, .grids = 2, .latents = 2};

/// Packets of a live source, each of so many bytes at most, that hold a burst of 8 MiB: a fifth of
/// a second of a full USB 2 bus. 64 where that is not known, and never less.
constexpr std::size_t packets_of_burst(std::size_t packet_bytes) {
    constexpr std::size_t kBurstBytes = std::size_t{8} << 20, kFewest = 64, kMost = 1024;
    if (packet_bytes == 0) return kFewest;
    return std::clamp(kBurstBytes / packet_bytes, kFewest, kMost);
}

/// A live source gets more packets where they are small, a recording fewer buffers of all kinds.
inline PipelineBuffers buffers_for(const Source& source) {
    return source.is_live() ? PipelineBuffers{.packets = packets_of_burst(source.packet_bytes())}
                            : kBuffersOfRecording;
}

struct PipelineSettings {
    int bins = 5;  ///< B of the model
    EventWindows::Settings event_windows;
    FrameRate rate;
    std::optional<SensorTime> frames_from;  ///< earlier event windows only warm up the state
    int lookahead = 0;                      ///< 0, 1 or 2: event windows a frame waits for
    /// For a live source: work is left out so that frames are no later than this (LatencyKeeper).
    /// Empty: latency is what the buffers hold. A recording waits in any case.
    std::optional<HostTime::duration> latency;
    bool reset_on_gap = false;      ///< begin with a new state where bytes were lost
    bool allow_silence = false;     ///< any number of frames in a row without events
    bool event_preview = false;     ///< fill Frame::event_preview
    bool events_per_pixel = false;  ///< fill LatentMap::events_per_pixel
    PipelineBuffers buffers;
    LiveChanges* changes = nullptr;  ///< borrowed; null: nothing is changed while it runs
    const PipelineState* resume =
        nullptr;             ///< borrowed until it is constructed; null: from nothing
    StateStops state_stops;  ///< of run_sequential() alone
    unsigned halvings = 0;   ///< every 2^n-th frame is rendered, until that is changed
};

/// All borrowed for the pipeline's life; filter and observer may be null.
struct PipelineParts {
    Source& source;
    EncodeStage& encoder;
    RenderStage& renderer;
    std::vector<Sink*> sinks;
    EventFilter* filter = nullptr;
    DataObserver* observer = nullptr;
};

/// One run from a source to sinks; made once for each. Threaded and sequential runs give the same
/// frames bit for bit, for any split of the bytes (a live source's losses and skipped frames
/// excepted, and what host time tells in its silence).
class Pipeline {
public:
    /// Throws Error: usage for settings out of range, input for a memory that does not fit.
    Pipeline(const PipelineParts& parts, const PipelineSettings& settings);

    /// Reads, bins and encodes on threads of its own; renders and writes on the caller's. Returns
    /// when the source has ended, nobody wants more, or after stop(); throws the first error of any
    /// thread. Frames in work when a source fails are still written. All sinks are closed, always.
    void run();

    /// The same, one after the other on the caller's thread.
    void run_sequential();

    /// Thread: any. What has been read is still finished, for at most about a second.
    void stop() noexcept;

    /// So far nobody has stopped it, and nothing has failed: at the sinks' close() it tells whether
    /// they have all that was asked for. Thread: any.
    bool is_whole() const { return !stop_.is_set() && !error_.is_there(); }

    Snapshot snapshot() const { return counters_.snapshot(); }  ///< Thread: any, at any time
    /// Slicer::end(). Thread: that of filter and observer.
    std::optional<SensorTime> end() const { return event_windows_.end(); }
    /// Slicer::began_anew(). Thread: likewise.
    bool clock_began_anew() const { return event_windows_.clock_began_anew(); }

private:
    // The four threads.
    void read();
    void bin();
    void encode();
    void present();

    // One step of each, for both kinds of run.
    bool read_one(RawPacket& into);
    Pool<RawPacket>::Handle packet_to_fill();
    void hand_on(const CutWindow& event_window);
    void cut(const RawPacket& packet);
    void keep_state(SensorTime t);
    void bin_one(const CutWindow& event_window, VoxelGrid& grid);
    void encode_one(const VoxelGrid& grid, Encoded& encoded);
    void present_one(Encoded& encoded);
    template <typename Body>
    void for_each_event_window(Body body);
    EventWindows::End ending() const;
    Encoded make_encoded() const;

    template <typename Handle>
    bool start(std::jthread& thread, const char* name, void (Pipeline::*work)(), Link<Handle>& out);
    template <typename Handle, typename Body>
    bool for_each(Link<Handle>& link, Body body);
    template <typename Body>
    bool guarded(Body body) noexcept;
    void close_and_report();

    const PipelineParts parts_;
    const PipelineSettings settings_;
    Counters counters_;
    StopRequest stop_;
    FirstError error_;
    LatencyKeeper keeper_;        // any thread
    RawPacket spill_;             // read thread
    EventWindows event_windows_;  // bin thread
    Binner binner_;               // bin thread

    Pool<RawPacket> packet_pool_;  // pools before links: a link may still hold handles when it dies
    Pool<VoxelGrid> grid_pool_;
    Pool<Encoded> latent_pool_;
    Link<Pool<RawPacket>::Handle> packets_;
    Link<Pool<VoxelGrid>::Handle> grids_;
    Link<Pool<Encoded>::Handle> latents_;

    FrameOutput output_;  // the caller's thread
};

}  // namespace eventide
