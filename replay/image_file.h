// An image file as a reference image.
#pragma once

#include "src/core/event.h"

#include <optional>
#include <string>

namespace eventide {

/// Reads pixels and channels (t stays zero); 8-bit values are scaled by 257. Empty when the file
/// cannot be read as an image of 1, 3 or 4 channels.
std::optional<ReferenceImage> read_image_file(const std::string& path);

struct ImageSize {
    int width = 0, height = 0;
};
std::optional<ImageSize> size_of_image_file(const std::string& path);

}  // namespace eventide
