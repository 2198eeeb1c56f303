// Frames as ROS 2 topics, without ROS 2: through Cyclone DDS.
#pragma once

#include "pipeline/calibration/calibration.h"
#include "pipeline/ros2/ros2_name.h"
#include "pipeline/sink.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace eventide {

struct Ros2SinkSettings {
    Ros2SinkName name;
    /// Of the frames as they come, whole; empty: name.calibration.
    std::optional<Calibration> calibration;
    bool with_sigma = true;  ///< else there is no topic of it
    ImageGeometry geometry;  ///< of the frames, for a calibration
    bool live = false;       ///< the stamps' offset follows the camera's drift
    /// Asked while it waits for subscribers: true gives up. May be empty.
    std::function<bool()> give_up = {};
    /// For people, once each; may be empty. Render thread, or the constructor's.
    std::function<void(const std::string&)> say = {}, warn = {};
    std::function<void(const std::string&)> detail = {};  ///< what Cyclone DDS says of itself
};

/// Writes NAMESPACE/image_raw, NAMESPACE/uncertainty, NAMESPACE/camera_info and, where asked for,
/// NAMESPACE/image_raw/compressed, all of one frame with the same header. A topic that nobody
/// reads is not written. docs/ros2.md is its manual. Throws Error: usage for the environment, input
/// for the calibration, failed where DDS cannot start; usage where the program was built without.
std::unique_ptr<Sink> open_ros2_sink(Ros2SinkSettings settings);

/// What `eventide doctor` says.
struct Ros2State {
    bool built = false, works = false;
    std::string found;
    std::string advice;  ///< what to do; may be empty
};

/// Joins and leaves the domain that the environment names.
Ros2State look_at_ros2();

}  // namespace eventide
