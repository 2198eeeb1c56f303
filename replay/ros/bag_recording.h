// ROS 1 bags as recordings.
#pragma once

#include "replay/data_reader.h"
#include "replay/open_options.h"

#include <memory>
#include <string>

namespace eventide {

/// Reads the first topic of each kind that the bag has: events (dvs_msgs/EventArray,
/// prophesee_event_msgs/EventArray, event_camera_msgs/EventPacket) and sensor_msgs/Image, where
/// those are of the events' size. Throws Error (input) where it is no bag, or one without events,
/// naming the types of messages that it has.
std::unique_ptr<DataReader> open_bag(const std::string& path, const OpenOptions& options);

}  // namespace eventide
