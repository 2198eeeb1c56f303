// Keys and values of a ROS 2 source's name.
#include "drivers/ros2/ros2_source_name.h"

#include "pipeline/ros2/ros2_name.h"
#include "src/core/duration_text.h"
#include "src/core/error.h"

namespace eventide {

Ros2SourceName parse_ros2_source_name(std::string_view text) {
    const KeyedName split = split_keys(std::string{text});
    check_ros2_name("topic", split.path);
    Ros2SourceName name;
    name.topic = split.path;
    for (const auto& [key, value] : split.keys) {
        if (key != "wait")
            throw Error(ErrorKind::usage, "ros2: key: expected wait, found '" + key + "'");
        const auto wait = read_duration(value);
        if (!wait || *wait < SensorDuration{0})
            throw Error(ErrorKind::usage,
                        "ros2: wait: expected a time such as 10s, found '" + value + "'");
        name.wait = *wait;
    }
    return name;
}

}  // namespace eventide
