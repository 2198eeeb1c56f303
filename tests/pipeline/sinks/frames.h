// Frames with known contents, for the sinks' tests.
#pragma once

#include "src/core/frame_data.h"

#include <cmath>

namespace eventide::test {

/// A slanted ramp that moves with n: every pixel and frame differs. Times are odd on purpose.
inline Frame ramp_frame(int width, int height, int n, SensorTime t) {
    Frame frame;
    frame.t = t;
    frame.window = {t - SensorDuration{5000}, t + SensorDuration{45'000}};
    frame.index = std::uint64_t(n);
    frame.events = std::uint64_t(100 + n);
    frame.intensity = Array2<float>{height, width};
    frame.sigma = Array2<float>{height, width};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            frame.intensity(y, x) = float((3 * x + 2 * y + 5 * n) % 256) / 255.0f;
            frame.sigma(y, x) = 0.1f + 0.001f * std::sin(float(x * y + n));
        }
    return frame;
}

/// 300 fps or so, with jitter: no two steps are equal.
inline SensorTime odd_time(int n) {
    return from_us(1'633'953'690'975'951 + 3331 * n + (n * n) % 97);
}

}  // namespace eventide::test
