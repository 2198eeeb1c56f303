// ROS 1 and 2 bags as recordings.
#pragma once

#include "replay/data_reader.h"
#include "replay/open_options.h"

#include <memory>
#include <string>

namespace eventide {

/// A ROS 1 bag. What is read of it says RosReader. Throws Error (input) where it is no bag, or one
/// without events, naming the types of messages that it has.
std::unique_ptr<DataReader> open_bag(const std::string& path, const OpenOptions& options);

/// A ROS 2 bag in an MCAP file, or a ROS 1 bag that was converted to one.
std::unique_ptr<DataReader> open_mcap(const std::string& path, const OpenOptions& options);

/// A ROS 2 bag in an SQLite file. Throws Error (failed) where eventide was built without SQLite.
std::unique_ptr<DataReader> open_db3(const std::string& path, const OpenOptions& options);

}  // namespace eventide
