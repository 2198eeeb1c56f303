// Encodings of sensor_msgs/Image.
#include "replay/ros/ros_image.h"

#include "src/core/byte_order.h"

#include <algorithm>
#include <array>
#include <utility>

namespace eventide {

namespace {

struct ImageKind {
    std::string_view encoding;
    int channels, bytes;
    bool rgb;  ///< in OpenCV's other order
    ColourFilter filter = ColourFilter::none;
};
constexpr std::array kImageKinds{
    ImageKind{"mono8", 1, 1, false},
    ImageKind{"8UC1", 1, 1, false},
    ImageKind{"mono16", 1, 2, false},
    ImageKind{"16UC1", 1, 2, false},
    ImageKind{"bgr8", 3, 1, false},
    ImageKind{"8UC3", 3, 1, false},
    ImageKind{"rgb8", 3, 1, true},
    ImageKind{"bgra8", 4, 1, false},
    ImageKind{"rgba8", 4, 1, true},
    ImageKind{"bayer_rggb8", 1, 1, false, ColourFilter::rggb},
    ImageKind{"bayer_grbg8", 1, 1, false, ColourFilter::grbg},
    ImageKind{"bayer_gbrg8", 1, 1, false, ColourFilter::gbrg},
    ImageKind{"bayer_bggr8", 1, 1, false, ColourFilter::bggr},
    ImageKind{"bayer_rggb16", 1, 2, false, ColourFilter::rggb},
    ImageKind{"bayer_grbg16", 1, 2, false, ColourFilter::grbg},
    ImageKind{"bayer_gbrg16", 1, 2, false, ColourFilter::gbrg},
    ImageKind{"bayer_bggr16", 1, 2, false, ColourFilter::bggr},
};

std::uint16_t pixel_of(const ImageKind& kind, const std::byte* at, bool big_endian) {
    if (kind.bytes == 1) return std::uint16_t(std::to_integer<int>(*at) * 257);
    return big_endian ? load_big<std::uint16_t>(at) : load_little<std::uint16_t>(at);
}

}  // namespace

std::optional<ReferenceImage> image_of(const RosImage& message) {
    const auto kind = std::ranges::find(kImageKinds, message.encoding, &ImageKind::encoding);
    if (kind == kImageKinds.end()) return {};
    const std::size_t pixel_bytes = std::size_t(kind->channels * kind->bytes);
    const std::size_t row_bytes = message.width * pixel_bytes;
    if (message.step < row_bytes ||
        message.bytes.size() < message.step * (message.height - 1) + row_bytes)
        return {};
    ReferenceImage image;
    image.channels = kind->channels;
    image.filter = kind->filter;
    image.pixels = Array2<std::uint16_t>(int(message.height), int(message.width) * kind->channels);
    for (std::uint32_t y = 0; y < message.height; ++y) {
        const auto row = image.pixels.row(int(y));
        const std::byte* const from = message.bytes.data() + y * message.step;
        for (std::size_t i = 0; i < row.size(); ++i)
            row[i] = pixel_of(*kind, from + i * std::size_t(kind->bytes), message.big_endian);
        if (kind->rgb)
            for (std::size_t i = 0; i < row.size(); i += std::size_t(kind->channels))
                std::swap(row[i], row[i + 2]);
    }
    return image;
}

}  // namespace eventide
