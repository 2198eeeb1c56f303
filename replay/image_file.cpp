// A picture file as a reference image; the one file of replay/ that uses OpenCV (imgcodecs).
#include "replay/image_file.h"

#include "src/io/input_file.h"

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include <filesystem>

namespace eventide {

namespace {

/// OpenCV throws on pictures it holds to be too large or broken; to us they are unreadable alike.
cv::Mat read_picture(const std::string& path) {
    // Otherwise OpenCV prints a warning of its own.
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) return {};
    try {
        open_to_read(path);
    } catch (const Error& error) {
        if (error.kind() == ErrorKind::failed) throw;  // no fault of the picture
        return {};
    }
    try {
        return cv::imread(path, cv::IMREAD_UNCHANGED);
    } catch (const cv::Exception&) {
        return {};
    }
}

}  // namespace

std::optional<ReferenceImage> read_image_file(const std::string& path) {
    const cv::Mat picture = read_picture(path);
    const int channels = picture.channels();
    if (picture.empty() || (picture.depth() != CV_8U && picture.depth() != CV_16U) ||
        (channels != 1 && channels != 3 && channels != 4))
        return {};
    ReferenceImage image;
    image.channels = channels;
    image.pixels = Array2<std::uint16_t>(picture.rows, picture.cols * channels);
    for (int y = 0; y < picture.rows; ++y) {
        const auto row = image.pixels.row(y);
        for (std::size_t i = 0; i < row.size(); ++i)
            row[i] = picture.depth() == CV_8U ? std::uint16_t(picture.ptr<std::uint8_t>(y)[i] * 257)
                                              : picture.ptr<std::uint16_t>(y)[i];
    }
    return image;
}

std::optional<ImageSize> size_of_image_file(const std::string& path) {
    const cv::Mat picture = read_picture(path);
    if (picture.empty()) return {};
    return ImageSize{picture.cols, picture.rows};
}

}  // namespace eventide
