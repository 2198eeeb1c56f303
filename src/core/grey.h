// Reference images as intensity.
#pragma once

#include "src/core/event.h"

#include <cstddef>

namespace eventide {

/// Grey of one pixel of the image, 0 to 1. Rec. 601, as cv::cvtColor: the luma that grey references
/// are made with.
inline float grey_at(const ReferenceImage& image, int y, int x) {
    const auto pixel = image.pixels.row(y).subspan(std::size_t(x * image.channels));
    const float grey = image.channels == 1 ? float(pixel[0])
                                           : .114F * float(pixel[0]) + .587F * float(pixel[1]) +
                                                 .299F * float(pixel[2]);
    return grey / 65535;
}

}  // namespace eventide
