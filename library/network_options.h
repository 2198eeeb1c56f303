// What the options of the public face say to the parts behind it.
#pragma once

#include "pipeline/filters/event_filter.h"
#include "pipeline/frame_clock.h"
#include "src/binning/slicer_settings.h"
#include "src/model/engine.h"
#include "src/model/model_file.h"

#include <eventide/error.h>
#include <eventide/reconstructor.h>

#include <memory>
#include <new>
#include <string>

namespace eventide {

/// A model file whose network was seen to work. Throws Error (input).
Model tried_model(const std::string& name);

/// Before anything is made for a sensor of this size. Throws Error (usage).
void check_sensor(int width, int height);

// Throw Error (usage) for what makes no sense.
SlicerSettings slicer_of(const ReconstructorOptions& options, const ModelConfig& config);
EngineOptions engine_of(const ReconstructorOptions& options);
FrameRate rate_of(const ReconstructorOptions& options);
/// Null where nothing is filtered.
std::unique_ptr<EventFilters> filter_of(const ReconstructorOptions& options,
                                        const ModelConfig& config, int width, int height);

/// Throws Error (usage) for a size that no frame has, and a region that is no part of it.
void check_frame_size(const FrameSize& size, int sensor_width, int sensor_height);

/// What `make` gives, and Error (failed) where there is too little memory for it.
template <typename Make>
auto with_enough_memory(const std::string& model, int width, int height, Make make) {
    try {
        return make();
    } catch (const std::bad_alloc&) {
        throw Error(ErrorKind::failed, "model '" + model + "' for a sensor of " +
                                           std::to_string(width) + "x" + std::to_string(height) +
                                           ": expected enough memory for it, found too little");
    }
}

}  // namespace eventide
