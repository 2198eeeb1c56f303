// Luma and 4:2:0 chroma; grey images have luma only.
#include "pipeline/sinks/video/yuv.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace eventide {

namespace {

/// Luma weights, and the divisors that bring B - Y and R - Y to +-0.5; then what becomes of 0 to
/// 255.
struct Coding {
    float red, green, blue, blue_span, red_span;
    float luma, offset, chroma;
    float luma_of(const std::uint8_t* bgr) const {
        return blue * float(bgr[0]) + green * float(bgr[1]) + red * float(bgr[2]);
    }
};
// Rec. ITU-R BT.601-7, 2.5, and BT.709-6, item 3.2.
constexpr Coding kJpeg{0.299f, 0.587f, 0.114f, 1.772f, 1.402f, 1.0f, 0.0f, 1.0f},
    kVideo{0.2126f, 0.7152f, 0.0722f, 1.8556f, 1.5748f, 219.0f / 255.0f, 16.0f, 224.0f / 255.0f};

constexpr const Coding& numbers_of(YuvCoding coding) {
    return coding == YuvCoding::jpeg ? kJpeg : kVideo;
}

std::uint8_t byte_of(float value) {
    // NOLINTNEXTLINE(bugprone-incorrect-roundings): never below 0
    return std::uint8_t(std::clamp(value, 0.0f, 255.0f) + 0.5f);
}

void grey_rows(const cv::Mat& image, YuvCoding coding, const std::array<Plane, 3>& planes) {
    const auto table = luma_table(coding);
    for (int y = 0; y < even(image.rows); ++y) {
        const auto* from = image.ptr<std::uint8_t>(std::min(y, image.rows - 1));
        std::uint8_t* into = planes[0].data + y * planes[0].stride;
        for (int x = 0; x < image.cols; ++x) into[x] = table[from[x]];
        into[even(image.cols) - 1] = into[image.cols - 1];
    }
    for (std::size_t c = 1; c < 3; ++c)
        for (int y = 0; y < even(image.rows) / 2; ++y)
            std::memset(planes[c].data + y * planes[c].stride, 128,
                        std::size_t(even(image.cols) / 2));
}

void colour_rows(const cv::Mat& image, YuvCoding coding, const std::array<Plane, 3>& planes) {
    const Coding& is = numbers_of(coding);
    const auto pixel = [&](int y, int x) {
        return image.ptr<std::uint8_t>(std::min(y, image.rows - 1)) +
               3 * std::min(x, image.cols - 1);
    };
    for (int y = 0; y < even(image.rows); ++y)
        for (int x = 0; x < even(image.cols); ++x)
            planes[0].data[y * planes[0].stride + x] =
                byte_of(is.luma_of(pixel(y, x)) * is.luma + is.offset);
    for (int y = 0; y < even(image.rows) / 2; ++y)
        for (int x = 0; x < even(image.cols) / 2; ++x) {
            float blue = 0, red = 0;
            for (const int dy : {0, 1})
                for (const int dx : {0, 1}) {
                    const std::uint8_t* bgr = pixel(2 * y + dy, 2 * x + dx);
                    blue += (float(bgr[0]) - is.luma_of(bgr)) / (4 * is.blue_span);
                    red += (float(bgr[2]) - is.luma_of(bgr)) / (4 * is.red_span);
                }
            planes[1].data[y * planes[1].stride + x] = byte_of(128.0f + blue * is.chroma);
            planes[2].data[y * planes[2].stride + x] = byte_of(128.0f + red * is.chroma);
        }
}

}  // namespace

std::array<std::uint8_t, 256> luma_table(YuvCoding coding) {
    const Coding& is = numbers_of(coding);
    std::array<std::uint8_t, 256> table{};
    for (std::size_t i = 0; i < 256; ++i) table[i] = byte_of(float(i) * is.luma + is.offset);
    return table;
}

void to_yuv420(const cv::Mat& image, YuvCoding coding, const std::array<Plane, 3>& planes) {
    if (image.channels() == 1)
        grey_rows(image, coding, planes);
    else
        colour_rows(image, coding, planes);
}

}  // namespace eventide
