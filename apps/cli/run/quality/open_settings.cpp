// What the settings of a run leave to --quality, and what they ask for.
#include "apps/cli/run/quality/open_settings.h"

#include "src/core/error.h"

#include <spdlog/spdlog.h>

#include <cmath>

namespace eventide::app {

namespace {

/// Where event windows end at the camera's images, each has its frame.
bool cuts_at_images(const RunSettings& settings) {
    return settings.window != "model" &&
           parse_window(settings.window).rule == WindowRule::reference;
}

}  // namespace

std::vector<std::string> models_to_choose_from(const RunSettings& settings) {
    // A state belongs to one model.
    if (settings.model_given || !settings.state_in.empty()) return {settings.model};
    return {"default", "small"};
}

bool chooses_quality(const RunSettings& settings, bool live, double pace) {
    if (settings.quality == QualityMode::fixed) {
        if (settings.budget.is_set())
            spdlog::info("--budget {}: nothing is chosen by it with --quality fixed",
                         show_budget(settings.budget));
        return false;
    }
    if (settings.budget.is_set() && pace <= 0)
        throw Error(ErrorKind::usage, "--budget " + show_budget(settings.budget) +
                                          ": expected a pace to hold, found " + settings.source +
                                          " as fast as possible; --realtime gives it one");
    if (settings.engine == Engine::plain) {
        if (settings.budget.is_set())
            spdlog::info("--budget {}: nothing is chosen by it with --engine plain",
                         show_budget(settings.budget));
        return false;
    }
    return live || settings.realtime || settings.budget.is_set();
}

bool rate_is_open(const RunSettings& settings) {
    return settings.fps.automatic && !cuts_at_images(settings);
}

/// --roi and --crop count pixels of the frame.
bool scale_is_open(const RunSettings& settings) {
    return !settings.size_given && !settings.region && settings.adjust.crop_px == 0;
}

double video_rate(const RunSettings& settings) {
    if (settings.fps.automatic) return cuts_at_images(settings) ? 0 : 30;
    const FrameRate& rate = settings.fps.rate;
    return rate.is_set() ? double(rate.frames) / double(rate.seconds) : 0;
}

QualityLevel asked_level(const RunSettings& settings, const SensorInfo& sensor) {
    if (!settings.size.exact) return {settings.size.scale, 0};
    const double area = double(settings.size.exact->width) * settings.size.exact->height /
                        (double(sensor.width) * sensor.height);
    return {std::sqrt(area), 0};
}

std::optional<SlicerSettings> windows_by_content(const RunSettings& settings,
                                                 const SlicerSettings& usual) {
    if (settings.window != "auto" || !rate_of(settings, usual).is_set()) return {};
    SlicerSettings slicer = parse_window("auto");
    slicer.max_width = natural_width(usual);
    return slicer;
}

}  // namespace eventide::app
