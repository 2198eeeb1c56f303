#include "library/network_options.h"

#include "pipeline/filters/event_filter.h"
#include "pipeline/parallel_tbb.h"
#include "src/core/error.h"
#include "src/core/sensor_limits.h"
#include "src/model/model_folders.h"
#include "src/model/model_trial.h"

namespace eventide {
namespace {

void check_side(int side, const char* name) {
    if (side < 1 || side > kLargestSensorSide)
        throw Error(ErrorKind::usage, std::string{"sensor "} + name + ": expected 1 to " +
                                          std::to_string(kLargestSensorSide) + " px, found " +
                                          std::to_string(side));
}

}  // namespace

Model tried_model(const std::string& name) {
    const std::filesystem::path file = find_model(name);
    Model model = load_model(file);
    try_model(model, file.string());
    return model;
}

void check_sensor(int width, int height) {
    check_side(width, "width");
    check_side(height, "height");
}

SlicerSettings slicer_of(const ReconstructorOptions& options, const ModelConfig& config) {
    return parse_window(options.window == "model" ? config.window : options.window);
}

EngineOptions engine_of(const ReconstructorOptions& options) {
    EngineOptions engine;
    engine.precision = options.precision;
    engine.kernels = options.kernels;
    engine.parallel_for = parallel_for_with(options.threads);
    return engine;
}

FrameRate rate_of(const ReconstructorOptions& options) {
    return options.fps == "frame" ? FrameRate{} : parse_frame_rate(options.fps);
}

std::unique_ptr<EventFilter> filter_of(const ReconstructorOptions& options,
                                       const ModelConfig& config, int width, int height) {
    return event_filter({options.hot_pixels, options.noise_filter}, config, width, height);
}

void check_frame_size(const FrameSize& size) {
    for (const int side : {size.width, size.height})
        if (side < 0 || side > kLargestFrameSide)
            throw Error(ErrorKind::usage,
                        "frame size: expected 1 to " + std::to_string(kLargestFrameSide) +
                            " px each way, or 0 for the sensor's, found " + std::to_string(side));
}

}  // namespace eventide
