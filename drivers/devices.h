// Which cameras there are, and how a name on the command line becomes one.
#pragma once

#include "drivers/camera.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace eventide {

struct CameraOptions {
    std::filesystem::path settings;  ///< a file of config/cameras; empty: the driver's defaults
    bool reconnect = false;          ///< wait for an unplugged camera to come back
    /// Asked while a camera that has to be waited for is opened: true gives up. May be empty.
    std::function<bool()> give_up = {};
    /// Told, in sentences for people, why a camera was passed over, or is waited for and not back
    /// yet, once each. Source thread. May be empty.
    std::function<void(const std::string&)> warn = {};
};

/// Whether a source on the command line names a camera rather than a file: "davis:", "v4l2:", ...
bool names_camera(std::string_view source);

/// Whether `source` names a camera or a simulation, and no file: for commands that read recordings
/// alone.
bool names_device_alone(const std::string& source);

/// "; did you mean davis:?" where a source that is none is nearly one, with a colon or without;
/// else empty.
std::string source_suggestion(std::string_view source);

/// davis:              the first DAVIS that can be used
/// davis:SERIAL        the one with this serial number
/// davis:BUS:ADDRESS   the one at this place (lsusb)
/// dvxplorer:, dvs128: in the same way
/// v4l2:/dev/videoN    an event sensor with a V4L2 driver
/// ros2:/TOPIC         event packets of a ROS 2 driver
/// udp://HOST:PORT?size=WxH  events that another program sends (UdpSource)
/// Throws Error: usage for a name that makes no sense or a driver that was not built, device for a
/// camera that cannot be used.
std::unique_ptr<Camera> open_camera(std::string_view source, const CameraOptions& options);

/// Every camera that can be seen, usable or not.
std::vector<CameraDescription> list_cameras();

}  // namespace eventide
