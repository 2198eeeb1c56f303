#include "library/network_options.h"

#include "pipeline/filters/event_filter.h"
#include "pipeline/parallel_tbb.h"
#include "src/core/error.h"
#include "src/core/sensor_limits.h"
#include "src/model/model_folders.h"
#include "src/model/model_trial.h"

#include <cstdint>
#include <string>

namespace eventide {
namespace {

void check_side(int side, const char* name) {
    if (side < 1 || side > kLargestSensorSide)
        throw Error(ErrorKind::usage, std::string{"sensor "} + name + ": expected 1 to " +
                                          std::to_string(kLargestSensorSide) + " px, found " +
                                          std::to_string(side));
}

/// Of a frame and the region of it that is wanted, px; as wide as sums of any two need.
struct Side {
    std::int64_t whole, at, part;
    bool lies_within() const { return at >= 0 && part >= 1 && at + part <= whole; }
};

Side side_of(int whole, int at, int part) {
    return {whole, at, part != 0 ? part : std::int64_t{whole} - at};
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
    engine.self_ensemble = options.self_ensemble;
    return engine;
}

FrameRate rate_of(const ReconstructorOptions& options) {
    return options.fps == "frame" ? FrameRate{} : parse_frame_rate(options.fps);
}

std::unique_ptr<EventFilters> filter_of(const ReconstructorOptions& options,
                                        const ModelConfig& config, int width, int height) {
    return event_filter({options.hot_pixels, options.noise_filter, options.lamp_flicker}, config,
                        width, height);
}

void check_frame_size(const FrameSize& size, int sensor_width, int sensor_height) {
    for (const int side : {size.width, size.height})
        if (side < 0 || side > kLargestFrameSide)
            throw Error(ErrorKind::usage,
                        "frame size: expected 1 to " + std::to_string(kLargestFrameSide) +
                            " px each way, or 0 for the sensor's, found " + std::to_string(side));
    const Region& r = size.region;
    const Side width = side_of(size.width != 0 ? size.width : sensor_width, r.x, r.width),
               height = side_of(size.height != 0 ? size.height : sensor_height, r.y, r.height);
    if (!width.lies_within() || !height.lies_within())
        throw Error(ErrorKind::usage,
                    "region: expected a part of the " + std::to_string(width.whole) + "x" +
                        std::to_string(height.whole) + " frame, found " +
                        std::to_string(width.part) + "x" + std::to_string(height.part) + " from " +
                        std::to_string(r.x) + "," + std::to_string(r.y));
}

}  // namespace eventide
