// What went through the pipeline, and what did not, by reason.
#pragma once

#include "pipeline/camera_counters.h"
#include "pipeline/counter.h"
#include "pipeline/pace/latency.h"
#include "pipeline/stages.h"
#include "src/binning/slicer.h"
#include "src/core/damage.h"
#include "src/core/frame_data.h"

#include <array>
#include <cstdint>
#include <optional>

namespace eventide {

/// The counters at one moment. Lost: could not be taken. Skipped: not rendered. Damaged: made no
/// sense.
struct Snapshot {
    // read
    /// Of the source, where it is a camera. Set by whoever has it.
    std::optional<CameraCounters> camera{};
    std::uint64_t packets = 0, bytes = 0;            ///< read from the source, also the lost ones
    std::uint64_t lost_packets = 0, lost_bytes = 0;  ///< of those: every buffer was in use

    // parse, event window, bin
    std::uint64_t parsed_bytes = 0;
    std::uint64_t gaps = 0;  ///< places where bytes are missing, here or already at the source
    std::uint64_t events = 0, images = 0, imu = 0, triggers = 0;  ///< parsed
    SensorDuration images_apart{0};     ///< from events; 0 where one clock tells both (ImageClock)
    std::uint64_t filtered_events = 0;  ///< left out by the event filter
    FlickerFound flicker;               ///< by the event filter
    Damage damaged;
    SlicerCounters slicing;
    std::uint64_t event_windows = 0, silent_windows = 0;  ///< silent: of those, without events
    std::uint64_t merged_windows = 0;  ///< became one with the one before, to keep --latency
    std::uint64_t window_events = 0;   ///< in event windows: behind filters, and in what was asked
    SensorTime begin{};                ///< of the first event window; valid where event_windows > 0
    Window window{};                   ///< the newest event window

    // encode
    std::uint64_t encoded = 0;  ///< event windows
    std::uint64_t state_resets = 0;

    // render, write
    std::uint64_t frames = 0;  ///< written
    /// Of the frame clock, but not rendered: too late for a live source (--latency), left out by a
    /// halved rate (--quality), or watched by no sink.
    std::uint64_t skipped_frames = 0;
    std::uint64_t broken_frames = 0;  ///< not finite, not written; the run ends with the first
    /// Times a sink that waited for somebody (a pause, a slow reader) asked whether to go on. Set
    /// by whoever gave it the question.
    std::uint64_t waits = 0;
    /// The camera's images: that corrected frames; that came too late for it, or were too many. Set
    /// by whoever has the stage (ModelRenderStage).
    std::uint64_t used_images = 0, dropped_images = 0;
    SensorTime newest_frame{};  ///< t of the last one written; valid where frames > 0

    LatencySummary latency;        ///< from the last packet a frame saw to the frame written
    LatencySummary bin, encode;    ///< work per event window
    LatencySummary take;           ///< the same before its frames: to follow the camera's images
    LatencySummary render, write;  ///< work per frame

    std::uint64_t lost() const { return lost_packets; }
};

/// The pipeline's own counters, grouped by the thread that counts so that no cache line is shared.
struct Counters {
    struct alignas(64) {
        Counter packets, bytes, lost_packets, lost_bytes;
    } read;
    struct alignas(64) {
        Counter bytes, gaps, events, images, imu, triggers, images_apart_us, filtered_events;
        std::array<Counter, kDamageReasons> damaged;
        Counter flicker_millihertz, last_flicker_millihertz, flicker_events;
        Counter before_begin, after_end, too_many, late, late_references, time_resets;
        Counter event_windows, silent_windows, merged_windows, window_events, begin_us,
            window_begin_us, window_end_us;
        LatencyHistogram work;
    } bin;
    struct alignas(64) {
        Counter encoded, state_resets;
        LatencyHistogram work;
    } encode;
    struct alignas(64) {
        Counter frames, skipped_frames, broken_frames, newest_us;
        LatencyHistogram latency, take, render, write;
    } present;

    void note(const Damage& damaged, const SlicerCounters& slicing);  ///< bin thread
    void note(const FlickerFound& flicker);                           ///< bin thread
    Snapshot snapshot() const;                                        ///< any thread
};

}  // namespace eventide
