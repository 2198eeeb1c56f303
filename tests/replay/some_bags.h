// ROS 1 bags of events and images.
#pragma once

#include "tests/io/bag_writer.h"

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace eventide::test {

inline constexpr std::uint32_t kEvents = 3, kImages = 5, kOther = 6;

inline ReferenceImage some_image(SensorTime t, int width, int height) {
    ReferenceImage made;
    made.t = made.exposure_begin = made.exposure_end = t;
    made.pixels = Array2<std::uint16_t>(height, width);
    for (std::size_t i = 0; i < made.pixels.values().size(); ++i)
        made.pixels.values()[i] = std::uint16_t(i * 3 % 256 * 257);
    return made;
}

/// Messages of 100 events and an image before each thousand, in chunks of 1000 events.
inline std::string bag_of(const std::vector<Event>& events, const std::string& packing,
                          const std::string& type = "dvs_msgs/EventArray", int image_width = 128) {
    BagBytes content, part = connection(kOther, "sensor_msgs/Imu") + connection(kEvents, type) +
                             connection(kImages, "sensor_msgs/Image") + message(kOther, "imu");
    for (std::size_t i = 0; i < events.size(); i += 100) {
        if (i % 1000 == 0)
            part += message(kImages, image(some_image(events[i].t, image_width, 128)));
        part += message(kEvents, event_array(128, 128, std::span(events).subspan(i, 100)));
        if (i % 1000 == 900) content += chunk(packing, std::exchange(part, {}));
    }
    return bag(content + (part.empty() ? "" : chunk(packing, part)),
               connection(kEvents, type) + connection(kImages, "sensor_msgs/Image"));
}

}  // namespace eventide::test
