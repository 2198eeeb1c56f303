// Reference images as intensity.
#pragma once

#include "src/core/event.h"

#include <array>
#include <cstddef>

namespace eventide {

/// Shares of blue, green and red in luma (ITU-R BT.601, as cv::cvtColor).
inline constexpr std::array<float, 3> kLumaBgr{.114F, .587F, .299F};

/// Grey of one pixel of the image, 0 to 1: the luma that grey references are made with.
inline float grey_at(const ReferenceImage& image, int y, int x) {
    const auto pixel = image.pixels.row(y).subspan(std::size_t(x * image.channels));
    const float grey = image.channels == 1
                           ? float(pixel[0])
                           : kLumaBgr[0] * float(pixel[0]) + kLumaBgr[1] * float(pixel[1]) +
                                 kLumaBgr[2] * float(pixel[2]);
    return grey / 65535;
}

}  // namespace eventide
