// Images for the tests of measures: the same everywhere, smooth with grain.
#pragma once

#include "src/core/array.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>

namespace eventide {

/// In double, so that tests/metrics/make_ssim_golden.py gives the same numbers.
inline double image_value(int y, int x, int seed) {
    std::int64_t n = std::int64_t{x} * 7919 + std::int64_t{y} * 104729 + seed * 1299709LL;
    n = n * (n % 1009 + 31) % 65536;
    const double smooth = .5 + .3 * std::sin(.13 * x + seed) * std::cos(.07 * y);
    return std::clamp(smooth + .2 * (double(n) / 65536 - .5), 0., 1.);
}

inline Array2<float> test_image(int height, int width, int seed) {
    Array2<float> out(height, width);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) out(y, x) = float(image_value(y, x, seed));
    return out;
}

/// Each number of `image` through `change`.
template <typename Change>
Array2<float> mapped(Array2<float> image, Change change) {
    for (float& v : image.values()) v = float(change(v));
    return image;
}

/// Real recordings and networks that are not part of the project; may be absent.
inline std::filesystem::path shared_data() {
    return std::filesystem::path{EVENTIDE_SOURCE_DIR} / "../shared/data";
}

}  // namespace eventide
