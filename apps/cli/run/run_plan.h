// What was asked for becomes what is to be done: spans, windows, rates, sizes.
#pragma once

#include "apps/cli/settings/run_settings.h"
#include "pipeline/calibration/undistortion.h"
#include "pipeline/filters/event_filter.h"
#include "pipeline/source.h"
#include "src/binning/slicer_settings.h"
#include "src/model/model_config.h"
#include "src/model/render/renderer.h"

#include <memory>
#include <optional>
#include <string>

namespace eventide::app {

/// Where a recording is to begin and end, in its own time; of a live source only how long it runs.
struct Span {
    std::optional<SensorTime> frames_from, begin, end;
    std::optional<SensorDuration> duration;
};

/// May read the beginning of the recording to find its first event. Throws Error (usage) for what
/// cannot be had: --from of a live source or, relative, of standard input.
Span span_of(const RunSettings& settings, bool live);

/// The span of a run that goes on from a state that was kept at `t`, from where a duration counts
/// without --from. Throws Error (usage) for frames from before it, and for a warm-up, which it has
/// no use for.
Span resumed_span(const RunSettings& settings, Span span, SensorTime t);

/// The times of --states-at, which goes with --states-out. Throws Error (usage) where they do not
/// ascend, or one of the two is missing.
std::vector<SensorTime> state_times_of(const RunSettings& settings);

/// Time of the first event; reads the recording's beginning. Empty for live sources, simulations
/// and what can be read but once.
std::optional<SensorTime> first_event_of(const RunSettings& settings, bool live);

/// The pace of a recording: 0 is as fast as possible. Throws Error (usage) for --realtime without a
/// pace.
double speed_of(const RunSettings& settings);

/// The bound of a live source's latency; empty where there is none. Throws Error (usage) for a
/// bound of a recording, which waits and loses nothing.
std::optional<HostTime::duration> latency_of(const RunSettings& settings, bool live);

SlicerSettings slicer_of(const RunSettings& settings, const ModelConfig& model, const Span& span,
                         bool live);

/// Frames per second of the video; none: one for each event window.
FrameRate video_rate_of(const RunSettings& settings, const SlicerSettings& slicer);

/// Frames per second of sensor time: --slow 10 asks for ten times the frames of the video's rate.
/// Throws Error (usage) for more than sensor time has microseconds.
FrameRate rate_of(const RunSettings& settings, const SlicerSettings& slicer);

/// Frames per second of the video, as far as it can be said before the run; `rate` is of sensor
/// time.
double nominal_fps(const FrameRate& rate, const SlicerSettings& slicer, double slow);

/// What was asked for, else 0 for live sources and 2 for recordings, or the most the model was
/// trained for.
int lookahead_of(const RunSettings& settings, const ModelConfig& model, bool live);

/// What a source's reference images are to people: "truth" of a simulation, "APS" of a camera that
/// is named, else (in folders, whose makers are not told) "reference".
std::string reference_caption(const SensorInfo& sensor);

/// Null when all events stay.
std::unique_ptr<EventFilters> filter_of(const RunSettings& settings, const ModelConfig& model,
                                        const SensorInfo& sensor, bool can_wait);

/// Empty: not asked for. Throws Error: input for a calibration that cannot be read or is of another
/// sensor, usage where it does not fit what else was asked for.
std::optional<UndistortionPlan> undistortion_of(const RunSettings& settings,
                                                const SensorInfo& sensor);

RenderRequest request_of(const RunSettings& settings, const SensorInfo& sensor, int lookahead,
                         const std::optional<UndistortionPlan>& undistortion);

}  // namespace eventide::app
