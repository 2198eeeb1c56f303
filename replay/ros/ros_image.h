// sensor_msgs/Image as an image.
#pragma once

#include "src/core/event.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace eventide {

/// The fields of a message, borrowed from it.
struct RosImage {
    std::uint32_t width = 0, height = 0;  ///< px
    std::string_view encoding;            ///< "mono8", "bayer_rggb8", ...
    bool big_endian = false;
    std::size_t step = 0;  ///< bytes from row to row
    std::span<const std::byte> bytes;
};

/// Its pixels, without a time. Empty for an encoding that is not read, and where the bytes are
/// fewer than the fields say. `width` and `height` are of a sensor.
std::optional<ReferenceImage> image_of(const RosImage& message);

}  // namespace eventide
