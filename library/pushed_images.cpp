// Images of cameras and of callers, before they correct frames.
#include "library/pushed_images.h"

#include "src/core/error.h"
#include "src/core/sensor_limits.h"

#include <cstdint>
#include <cstdlib>
#include <string>

namespace eventide {

void check_image(const ReferenceImage& image) {
    const int channels = image.channels, width = image.pixels.width();
    if ((channels != 1 && channels != 3 && channels != 4) || width % channels != 0)
        throw Error(ErrorKind::usage,
                    "image: expected 1, 3 or 4 channels and whole pixels, found " +
                        std::to_string(channels) + " channels and rows of " +
                        std::to_string(width) + " numbers");
    const auto far = [](int at) { return at < -kLargestSensorSide || at > kLargestSensorSide; };
    if (far(image.x0) || far(image.y0))
        throw Error(ErrorKind::usage,
                    "image: expected a corner at most " + std::to_string(kLargestSensorSide) +
                        " px from the sensor's, found one at " + std::to_string(image.x0) + "," +
                        std::to_string(image.y0));
    if (image.exposure_end < image.exposure_begin)
        throw Error(ErrorKind::usage,
                    "image: expected an exposure_end not before exposure_begin, found " +
                        std::to_string(to_us(image.exposure_end)) + " us before " +
                        std::to_string(to_us(image.exposure_begin)) + " us");
}

/// 1 2 1 along both axes: every square of 2 x 2 sites has the same share in each pixel. Beyond an
/// edge lies what is beside it on the other side, which saw the same colour.
ReferenceImage without_mosaic(const ReferenceImage& image) {
    const int height = image.pixels.height(), width = image.pixels.width();
    if (image.filter == ColourFilter::none || image.channels != 1 || height < 2 || width < 2)
        return image;
    ReferenceImage grey = image;
    grey.filter = ColourFilter::none;
    const auto other = [](int i, int size) { return i < 0 ? 1 : i >= size ? size - 2 : i; };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            std::uint32_t sum = 0;
            for (int dy = -1; dy <= 1; ++dy)
                for (int dx = -1; dx <= 1; ++dx)
                    sum += std::uint32_t((2 - std::abs(dy)) * (2 - std::abs(dx))) *
                           image.pixels(other(y + dy, height), other(x + dx, width));
            grey.pixels(y, x) = std::uint16_t((sum + 8) / 16);
        }
    return grey;
}

void tell_filter(ColourFilter filter, std::vector<ReferenceImage>& images) {
    for (ReferenceImage& image : images)
        if (image.channels == 1 && image.filter == ColourFilter::none) image.filter = filter;
}

}  // namespace eventide
