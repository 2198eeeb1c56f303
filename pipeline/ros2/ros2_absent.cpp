// Built in place of the rest where there is no Cyclone DDS.
#include "pipeline/ros2/ros2_sink.h"
#include "src/core/error.h"

namespace eventide {

namespace {

constexpr const char* kHow =
    "install cyclonedds-dev, cyclonedds-tools and libyaml-dev (scripts/install-packages.sh does) "
    "and build eventide again";

}  // namespace

std::unique_ptr<Sink> open_ros2_sink(Ros2SinkSettings settings) {
    throw Error(ErrorKind::usage, "ros2:" + settings.name.name_space +
                                      ": this eventide was built without EVENTIDE_ROS2; " + kHow);
}

Ros2State look_at_ros2() {
    return {false, false, "built without EVENTIDE_ROS2", kHow};
}

}  // namespace eventide
