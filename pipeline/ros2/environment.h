// What ROS 2 and Cyclone DDS take from the environment.
#pragma once

#include <functional>
#include <string>

namespace eventide {

struct Ros2Environment {
    unsigned domain = 0;  ///< ROS_DOMAIN_ID, 0 to 232
    /// For dds_create_domain(): our own settings, then what ROS's variables ask for, then
    /// CYCLONEDDS_URI. What comes later wins.
    std::string config;
    bool configured = false;  ///< there is a CYCLONEDDS_URI
};

/// `variable` gives a variable's value, or null: environment_value() in programs. Reads
/// ROS_DOMAIN_ID, ROS_LOCALHOST_ONLY, ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_STATIC_PEERS and
/// CYCLONEDDS_URI, as rmw_cyclonedds_cpp does. Throws Error (usage) for a value that makes no
/// sense.
Ros2Environment ros2_environment(const std::function<const char*(const char*)>& variable);

}  // namespace eventide
