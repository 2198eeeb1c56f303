// An image file as a reference image; the one file of replay/ that uses OpenCV (imgcodecs).
#include "replay/image_file.h"

#include "src/io/image_codecs.h"
#include "src/io/input_file.h"

#include <opencv2/core.hpp>

#include <filesystem>

namespace eventide {

namespace {

/// OpenCV throws on images it holds to be too large or broken; to us they are unreadable alike.
cv::Mat read_image_pixels(const std::string& path) {
    // Otherwise OpenCV prints a warning of its own.
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) return {};
    try {
        open_to_read(path);
    } catch (const Error& error) {
        if (error.kind() == ErrorKind::failed) throw;  // no fault of the image
        return {};
    }
    try {
        return read_image(path, cv::IMREAD_UNCHANGED);
    } catch (const cv::Exception&) {
        return {};
    }
}

}  // namespace

std::optional<ReferenceImage> read_image_file(const std::string& path) {
    const cv::Mat decoded = read_image_pixels(path);
    const int channels = decoded.channels();
    if (decoded.empty() || (decoded.depth() != CV_8U && decoded.depth() != CV_16U) ||
        (channels != 1 && channels != 3 && channels != 4))
        return {};
    ReferenceImage image;
    image.channels = channels;
    image.pixels = Array2<std::uint16_t>(decoded.rows, decoded.cols * channels);
    for (int y = 0; y < decoded.rows; ++y) {
        const auto row = image.pixels.row(y);
        for (std::size_t i = 0; i < row.size(); ++i)
            row[i] = decoded.depth() == CV_8U ? std::uint16_t(decoded.ptr<std::uint8_t>(y)[i] * 257)
                                              : decoded.ptr<std::uint16_t>(y)[i];
    }
    return image;
}

std::optional<ImageSize> size_of_image_file(const std::string& path) {
    const cv::Mat decoded = read_image_pixels(path);
    if (decoded.empty()) return {};
    return ImageSize{decoded.cols, decoded.rows};
}

}  // namespace eventide
