// Images of a camera, and what a model shows, for tests of their fusion.
#pragma once

#include "src/core/frame_data.h"

#include <algorithm>
#include <cmath>

namespace eventide::test {

constexpr int kHeight = 30, kWidth = 44;

inline SensorTime at_ms(double ms) {
    return SensorTime{SensorDuration{std::int64_t(ms * 1000)}};
}

inline ReferenceImage image_of(const Array2<float>& intensity, SensorTime t) {
    ReferenceImage image;
    image.t = image.exposure_begin = image.exposure_end = t;
    image.pixels = Array2<std::uint16_t>(intensity.height(), intensity.width());
    for (std::size_t i = 0; i < intensity.values().size(); ++i)
        image.pixels.values()[i] =
            std::uint16_t(std::lround(65535 * std::clamp(intensity.values()[i], 0.F, 1.F)));
    return image;
}

inline Array2<float> constant(float value, int height = kHeight, int width = kWidth) {
    Array2<float> map(height, width);
    std::ranges::fill(map.values(), value);
    return map;
}

inline Array2<float> ramp(int height = kHeight, int width = kWidth) {
    Array2<float> map(height, width);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) map(y, x) = .1F + .8F * (float(x) + .5F) / float(width);
    return map;
}

/// What a model shows that paints everything in one grey.
inline Frame grey(float value, SensorTime t, int height = kHeight, int width = kWidth) {
    Frame frame;
    frame.t = t;
    frame.intensity = constant(value, height, width);
    frame.sigma = constant(.2F, height, width);
    return frame;
}

}  // namespace eventide::test
