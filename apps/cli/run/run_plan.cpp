// What was asked for becomes what is to be done.
#include "apps/cli/run/run_plan.h"

#include "apps/cli/commands/look_ahead.h"
#include "apps/cli/run/open_sinks.h"
#include "drivers/simulated/simulated_name.h"
#include "pipeline/filters/event_filter.h"
#include "src/core/error.h"

#include <spdlog/spdlog.h>

#include <algorithm>

namespace eventide::app {

namespace {

/// Half a dozen of the widest windows and more of the usual ones: what a scene has to show in that
/// time the network has seen.
constexpr SensorDuration kWarmup{1'000'000};

/// As long before the first frame as was asked for, and no earlier than the first event: silence
/// teaches nothing. What is read once cannot be asked for its first event.
SensorTime warm_up_from(const RunSettings& settings, const TimePointReader& times,
                        SensorTime frames_from) {
    const SensorDuration usual = settings.state_in.empty() ? kWarmup : SensorDuration{0};
    const SensorTime begin = frames_from - settings.warmup.value_or(usual);
    if (is_read_once(settings.source) || begin == frames_from) return begin;
    return std::min(std::max(begin, times.time_of({})), frames_from);
}

TimePointReader times_of(const RunSettings& settings) {
    if (names_simulation(settings.source)) return TimePointReader{SimRecordingSettings{}.begin};
    return TimePointReader{settings.source, settings.input.options()};
}

}  // namespace

std::optional<SensorTime> first_event_of(const RunSettings& settings, bool live) {
    if (live || is_read_once(settings.source) || names_simulation(settings.source)) return {};
    return times_of(settings).time_of({});
}

Span span_of(const RunSettings& settings, bool live) {
    Span span;
    if (live) {
        if (settings.from || settings.to)
            throw Error(ErrorKind::usage,
                        "--from and --to are for recordings; --duration ends a live source");
        span.duration = settings.duration;
        return span;
    }
    const TimePointReader times = times_of(settings);
    if (settings.from) {
        span.frames_from = times.time_of(*settings.from);
        span.begin = warm_up_from(settings, times, *span.frames_from);
    }
    if (settings.to) span.end = times.time_of(*settings.to);
    if (settings.duration && !settings.from && !settings.to && is_read_once(settings.source)) {
        span.duration = settings.duration;  // from its first event on, as of a live source
    } else if (settings.duration) {
        const SensorTime begin = span.frames_from ? *span.frames_from : times.time_of({});
        const SensorTime end = begin + *settings.duration;
        span.end = span.end ? std::min(*span.end, end) : end;
    }
    check_order(span.frames_from, span.end);
    return span;
}

Span resumed_span(const RunSettings& settings, Span span, SensorTime t) {
    const std::string option = "--state-in " + settings.state_in;
    if (settings.warmup)
        throw Error(ErrorKind::usage, option + ": expected no --warmup; it begins with the state");
    const SensorTime begin = t + SensorDuration{1};
    if (span.frames_from.value_or(begin) < begin)
        throw Error(ErrorKind::usage, option + ": expected --from after the state's time, " +
                                          std::to_string(to_us(t)) + " us, found " +
                                          std::to_string(to_us(*span.frames_from)) + " us");
    span.begin = begin;
    span.frames_from = span.frames_from.value_or(begin);
    if (settings.duration && !settings.from) {
        const SensorTime end = begin + *settings.duration;
        span.end = settings.to ? std::min(times_of(settings).time_of(*settings.to), end) : end;
    }
    if (!settings.from && span.end && *span.end < begin)
        throw Error(ErrorKind::usage, option + ": expected --to after the state's time, " +
                                          std::to_string(to_us(t)) + " us, found " +
                                          std::to_string(to_us(*span.end)) + " us");
    return span;
}

namespace {

TimePoint state_point(const std::string& text) {
    try {
        return parse_time_point(text);
    } catch (const Error& error) {
        throw Error(error.kind(), "--states-at: " + std::string{error.what()});
    }
}

}  // namespace

std::vector<SensorTime> state_times_of(const RunSettings& settings) {
    if (settings.states_at.empty() != settings.states_out.empty())
        throw Error(ErrorKind::usage, "--states-out and --states-at: expected both, found one");
    const TimePointReader reader = times_of(settings);
    std::vector<SensorTime> times;
    for (const std::string& text : settings.states_at) {
        const SensorTime t = reader.time_of(state_point(text));
        if (!times.empty() && t <= times.back())
            throw Error(ErrorKind::usage,
                        "--states-at " + text + ": expected times that ascend, found one before");
        times.push_back(t);
    }
    return times;
}

double speed_of(const RunSettings& settings) {
    if (settings.speed == "max" && settings.realtime)
        throw Error(ErrorKind::usage,
                    "--realtime: expected a pace, found --speed max; leave one of them out");
    if (settings.speed == "max") return 0;
    if (settings.speed == "auto")
        return settings.realtime || std::ranges::any_of(settings.out, is_window) ||
                       std::ranges::any_of(settings.out, is_http)
                   ? 1 / settings.slow
                   : 0;
    return parse_number(settings.speed, 0.001, 1000);
}

std::optional<HostTime::duration> latency_of(const RunSettings& settings, bool live) {
    constexpr std::chrono::milliseconds kUsual{250};
    if (settings.latency == "none") return {};
    if (settings.latency == "auto")
        return live ? std::optional<HostTime::duration>{kUsual} : std::nullopt;
    if (!live)
        throw Error(ErrorKind::usage,
                    "--latency " + settings.latency + ": expected a camera as SOURCE, found " +
                        settings.source + "; a recording waits, and loses nothing");
    return parse_duration(settings.latency);
}

SlicerSettings slicer_of(const RunSettings& settings, const ModelConfig& model, const Span& span,
                         bool live) {
    // Short windows cost more: what a recording waits for, a camera would lose.
    const bool of_model = settings.window == "model" || (settings.window == "auto" && live);
    SlicerSettings slicer = parse_window(of_model ? model.window : settings.window);
    // A window is (begin, end]: the event of the very moment asked for is in it.
    if (span.begin) slicer.begin = *span.begin - SensorDuration{1};
    slicer.end = span.end;
    slicer.duration = span.duration;
    return slicer;
}

FrameRate video_rate_of(const RunSettings& settings, const SlicerSettings& slicer) {
    if (!settings.fps.automatic) return settings.fps.rate;
    return slicer.rule == WindowRule::reference ? FrameRate{} : FrameRate{30, 1};
}

FrameRate rate_of(const RunSettings& settings, const SlicerSettings& slicer) {
    return slowed(video_rate_of(settings, slicer), settings.slow);
}

double nominal_fps(const FrameRate& rate, const SlicerSettings& slicer, double slow) {
    if (rate.is_set()) return double(rate.frames) / double(rate.seconds) / slow;
    return slicer.rule == WindowRule::duration ? 1e6 / double(slicer.width.count()) / slow : 30;
}

int lookahead_of(const RunSettings& settings, const ModelConfig& model, bool live) {
    const int lookahead = settings.lookahead.value_or(live ? 0 : 2);
    if (std::ranges::find(model.lookaheads, lookahead) == model.lookaheads.end()) {
        if (settings.lookahead) {
            spdlog::warn("the model was not trained for lookahead {}", lookahead);
        } else {
            const auto best = std::ranges::max_element(model.lookaheads);
            return best == model.lookaheads.end() ? lookahead : *best;
        }
    }
    return lookahead;
}

std::string reference_caption(const SensorInfo& sensor) {
    if (sensor.name.starts_with("simulated")) return "truth";
    return sensor.name.empty() ? "reference" : "APS";
}

std::unique_ptr<EventFilters> filter_of(const RunSettings& settings, const ModelConfig& model,
                                        const SensorInfo& sensor, bool can_wait) {
    return event_filter(
        {settings.hot_pixels, settings.noise_filter, settings.lamp_flicker, can_wait}, model,
        sensor.width, sensor.height);
}

std::optional<UndistortionPlan> undistortion_of(const RunSettings& settings,
                                                const SensorInfo& sensor) {
    if (settings.undistort.empty()) {
        if (!settings.undistort_camera.empty())
            throw Error(ErrorKind::usage, "--undistort-camera " + settings.undistort_camera +
                                              ": expected --undistort FILE, found none");
        return {};
    }
    const std::string option = "--undistort " + settings.undistort;
    for (const std::string& filter : settings.filter)
        if (filter.starts_with("flip:") || filter == "transpose")
            throw Error(ErrorKind::usage, option +
                                              ": the calibration is of the sensor as it is; "
                                              "expected no --filter " +
                                              filter + "; --flip mirrors undistorted frames");
    const Calibration calibration = read_calibration(settings.undistort, settings.undistort_camera);
    if (calibration.width != sensor.width || calibration.height != sensor.height)
        throw Error(ErrorKind::input, option + ": expected the calibration of a sensor of " +
                                          show_size({sensor.width, sensor.height}) +
                                          ", found one of " +
                                          show_size({calibration.width, calibration.height}));
    const Size whole = settings.size.of({sensor.width, sensor.height});
    return plan_undistortion(calibration, whole.width, whole.height,
                             settings.region.value_or(Region{}));
}

RenderRequest request_of(const RunSettings& settings, const SensorInfo& sensor, int lookahead,
                         const std::optional<UndistortionPlan>& undistortion) {
    const Size size = settings.size.of({sensor.width, sensor.height});
    RenderRequest request;
    request.width = size.width;
    request.height = size.height;
    if (settings.region) request.region = undistortion ? undistortion->source : *settings.region;
    request.lookahead = lookahead;
    request.sigma_rule = settings.sigma_rule;
    request.want_sigma = settings.uncertainty != Uncertainty::none;
    return request;
}

}  // namespace eventide::app
