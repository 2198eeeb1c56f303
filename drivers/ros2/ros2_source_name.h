// "ros2:/event_camera/events?wait=30s": what such a name says.
#pragma once

#include "src/core/sensor_time.h"

#include <string>
#include <string_view>

namespace eventide {

struct Ros2SourceName {
    std::string topic;                ///< "/event_camera/events"
    SensorDuration wait{10'000'000};  ///< for the first message, before it is an error
};

/// What follows "ros2:". Throws Error (usage) naming the key, what it expects and what was found.
Ros2SourceName parse_ros2_source_name(std::string_view name);

}  // namespace eventide
