// What was asked for becomes what is to be done.
#include "src/app/run_plan.h"

#include "drivers/simulated/simulated_name.h"
#include "pipeline/filters/hot_pixels.h"
#include "src/app/open_sinks.h"
#include "src/core/error.h"

#include <spdlog/spdlog.h>

#include <algorithm>

namespace eventide::app {

Span span_of(const RunSettings& settings, bool live) {
    Span span;
    if (live) {
        if (settings.from || settings.to)
            throw Error(ErrorKind::usage,
                        "--from and --to are for recordings; --duration ends a live source");
        span.duration = settings.duration;
        return span;
    }
    const MomentReader moments = names_simulation(settings.source)
                                     ? MomentReader{SimRecordingSettings{}.begin}
                                     : MomentReader{settings.source, settings.input.options()};
    if (settings.from) {
        span.frames_from = moments.time_of(*settings.from);
        span.begin = *span.frames_from - settings.warmup;
    }
    if (settings.to) span.end = moments.time_of(*settings.to);
    if (settings.duration) {
        const SensorTime begin = span.frames_from ? *span.frames_from : moments.time_of({});
        const SensorTime end = begin + *settings.duration;
        span.end = span.end ? std::min(*span.end, end) : end;
    }
    if (span.end && span.frames_from && *span.end <= *span.frames_from)
        throw Error(ErrorKind::usage, "--to lies before --from");
    return span;
}

double speed_of(const RunSettings& settings) {
    if (settings.speed == "max") return 0;
    if (settings.speed == "auto") return std::ranges::any_of(settings.out, is_window) ? 1 : 0;
    return parse_number(settings.speed, 0.001, 1000);
}

SlicerSettings slicer_of(const RunSettings& settings, const ModelConfig& model, const Span& span) {
    SlicerSettings slicer =
        parse_window(settings.window == "auto" ? model.window : settings.window);
    slicer.begin = span.begin;
    slicer.end = span.end;
    slicer.duration = span.duration;
    return slicer;
}

FrameRate rate_of(const RunSettings& settings, const SlicerSettings& slicer) {
    if (!settings.fps.automatic) return settings.fps.rate;
    return slicer.rule == SliceRule::reference ? FrameRate{} : FrameRate{30, 1};
}

double nominal_fps(const FrameRate& rate, const SlicerSettings& slicer) {
    if (rate.is_set()) return double(rate.frames) / double(rate.seconds);
    return slicer.rule == SliceRule::duration ? 1e6 / double(slicer.width.count()) : 30;
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

std::unique_ptr<EventFilter> filter_of(const RunSettings& settings, const SensorInfo& sensor) {
    if (settings.hot_pixels == "off") return nullptr;
    if (settings.hot_pixels == "learn")
        return std::make_unique<HotPixelFilter>(sensor.width, sensor.height);
    return std::make_unique<HotPixelFilter>(sensor.width, sensor.height, settings.hot_pixels);
}

RenderRequest request_of(const RunSettings& settings, const SensorInfo& sensor, int lookahead) {
    const Size size = settings.size.of({sensor.width, sensor.height});
    RenderRequest request;
    request.width = size.width;
    request.height = size.height;
    if (settings.region) request.region = *settings.region;
    request.lookahead = lookahead;
    if (settings.sigma_rule != SigmaChoice::model)
        request.sigma_rule =
            settings.sigma_rule == SigmaChoice::mixture ? SigmaRule::mixture : SigmaRule::log_blend;
    request.want_sigma = settings.uncertainty != Uncertainty::none;
    return request;
}

}  // namespace eventide::app
