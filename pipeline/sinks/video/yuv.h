// 8-bit images as Y, U and V planes with 4:2:0 chroma: what players and Y4M readers take.
#pragma once

#include <opencv2/core.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

namespace eventide {

/// One plane of bytes; rows are `stride` bytes apart.
struct Plane {
    std::uint8_t* data = nullptr;
    std::ptrdiff_t stride = 0;
};

/// What readers undo without being told.
enum class YuvCoding {
    jpeg,  ///< of JPEG and of Y4M: BT.601, black 0, white 255; grey values stay as they are
    video  ///< of video files, which say BT.709: black 16, white 235, as of webcams
};

/// The next even number: 4:2:0 has no half pixels.
constexpr int even(int size) {
    return size + (size & 1);
}

/// [grey]: in the Y plane.
std::array<std::uint8_t, 256> luma_table(YuvCoding coding);

/// `image` is CV_8UC1 or CV_8UC3 (BGR). The Y plane is even(cols) x even(rows), U and V half of
/// that in both directions; an added column or row repeats the last.
void to_yuv420(const cv::Mat& image, YuvCoding coding, const std::array<Plane, 3>& planes);

}  // namespace eventide
