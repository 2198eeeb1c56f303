// Controls of V4L2 nodes and subdevices: biases above all.
#pragma once

#include "pipeline/video_node.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace eventide {

/// What to look at where the node of the sensor's driver is missing, or in use.
inline constexpr const char* kIfNoSensor = "is the driver loaded and the sensor connected?";
inline constexpr const char* kIfSensorBusy = "in use by another program";

/// A node or subdevice for its controls. Throws Error (device).
FileDescriptor open_for_controls(const std::filesystem::path& node);

/// Sets controls by the name the driver gives them ("bias_fo", "erc_enable") or v4l2-ctl lists them
/// by ("vertical_flip" for "Vertical Flip"), and reads each back;
/// one that cannot be written has to have the value already. `places` tells where each was said,
/// for messages. Throws Error (usage) naming the control that is unknown, read-only or out of
/// range, before any is set.
void set_v4l2_controls(int fd, const std::string& device,
                       const std::map<std::string, std::int64_t>& wanted,
                       const std::map<std::string, std::string>& places = {});

/// Size of the sensor from its subdevice (CROP_BOUNDS); empty where it does not say. Throws Error
/// (device) for one that cannot be opened.
std::optional<std::pair<int, int>> subdevice_size(const std::filesystem::path& subdevice);

}  // namespace eventide
