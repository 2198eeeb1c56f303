// "ros2:/camera?encoding=mono16&lazy=yes": what such a name says.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace eventide {

/// Names of sensor_msgs/image_encodings.
enum class ImageEncoding {
    mono8,   ///< 255 white
    mono16,  ///< 65535 white, little endian; of sigma: 65535 is 1, the whole intensity range
    float32  ///< 32FC1: 1 white, not clamped
};

std::string name_of(ImageEncoding encoding);

/// Of image_raw/compressed.
enum class ImageCompression { none, jpeg, png };

/// What stands in header.stamp.
enum class StampRule {
    automatic,  ///< the sensor's time where that counts from 1970, else as `arrival`
    sensor,     ///< the sensor's time as it is
    arrival     ///< the sensor's time, shifted so that it agrees with when its data arrived
};

/// What follows "ros2:" of a sink.
struct Ros2SinkName {
    std::string name_space;  ///< "/camera", in front of "/image_raw"; empty: the root
    ImageEncoding encoding = ImageEncoding::mono8;
    ImageEncoding uncertainty = ImageEncoding::mono16;
    ImageCompression compressed = ImageCompression::none;  ///< none: no such topic
    std::string calibration;         ///< a file of ROS or Kalibr; empty: camera_info has sizes only
    std::string calibration_camera;  ///< of a Kalibr file with several: "cam1"; empty: the first
    std::string frame_id;            ///< of tf; the last part of the name space where not given
    bool lazy = false;               ///< nothing is rendered for it while nobody subscribes
    int subscribers = 0;             ///< of image_raw, to wait for before the first frame
    StampRule stamp = StampRule::automatic;
};

/// /NAMESPACE?KEY=VALUE&..., the keys as the members above; encoding: mono8, mono16, 32FC1.
/// Throws Error (usage) naming the key, what it expects and what was found.
Ros2SinkName parse_ros2_sink_name(const std::string& name);

/// "/a/b?k=v&l=w" taken apart.
struct KeyedName {
    std::string path;
    std::vector<std::pair<std::string, std::string>> keys;
};

/// Throws Error (usage) for a key without "=".
KeyedName split_keys(const std::string& name);

/// A name of ROS: "/" and parts of letters, digits and underscores, none beginning with a digit.
/// Throws Error (usage) for any other. `what` is for the message.
void check_ros2_name(std::string_view what, std::string_view name);

}  // namespace eventide
