// Images of a part of the sensor, for formats that have no place for where it lies.
#pragma once

#include "src/core/event.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace eventide {

/// px
inline bool covers_sensor(const ReferenceImage& image, int width, int height) {
    return image.x0 == 0 && image.y0 == 0 && image.pixels.width() == width * image.channels &&
           image.pixels.height() == height;
}

/// On black, at its place; what lies outside the sensor is cut off.
inline ReferenceImage on_whole_sensor(const ReferenceImage& image, int width, int height) {
    ReferenceImage whole = image;
    whole.x0 = whole.y0 = 0;
    whole.pixels = Array2<std::uint16_t>(height, width * image.channels);
    const auto end = [](int begin, int size, int most) {
        return int(std::min<std::int64_t>(std::int64_t(begin) + size, most));
    };
    const int left = std::max(image.x0, 0), top = std::max(image.y0, 0);
    const int right = end(image.x0, image.pixels.width() / image.channels, width);
    const int bottom = end(image.y0, image.pixels.height(), height);
    for (int y = top; y < bottom && left < right; ++y) {
        const auto from = image.pixels.row(y - image.y0);
        const auto to = whole.pixels.row(y);
        std::copy_n(from.begin() + std::ptrdiff_t(left - image.x0) * image.channels,
                    std::ptrdiff_t(right - left) * image.channels,
                    to.begin() + std::ptrdiff_t(left) * image.channels);
    }
    return whole;
}

}  // namespace eventide
