// BT.709 luma and 4:2:0 chroma; grey images have luma only.
#include "pipeline/sinks/video/yuv.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace eventide {

namespace {

// Rec. ITU-R BT.709-6, item 3.2: luma weights, and the divisors that bring B - Y and R - Y to
// +-0.5.
constexpr float kRed = 0.2126f, kGreen = 0.7152f, kBlue = 0.0722f;
constexpr float kBlueSpan = 1.8556f, kRedSpan = 1.5748f;

struct Scale {
    float luma, offset, chroma;
};

constexpr Scale scale_of(YuvRange range) {
    return range == YuvRange::full ? Scale{1.0f, 0.0f, 1.0f}
                                   : Scale{219.0f / 255.0f, 16.0f, 224.0f / 255.0f};
}

std::uint8_t byte_of(float value) {
    return std::uint8_t(std::clamp(value, 0.0f, 255.0f) + 0.5f);
}

void grey_rows(const cv::Mat& image, YuvRange range, const std::array<Plane, 3>& planes) {
    const auto table = luma_table(range);
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

float luma_of(const std::uint8_t* bgr) {
    return kBlue * float(bgr[0]) + kGreen * float(bgr[1]) + kRed * float(bgr[2]);
}

void colour_rows(const cv::Mat& image, YuvRange range, const std::array<Plane, 3>& planes) {
    const Scale scale = scale_of(range);
    const auto pixel = [&](int y, int x) {
        return image.ptr<std::uint8_t>(std::min(y, image.rows - 1)) +
               3 * std::min(x, image.cols - 1);
    };
    for (int y = 0; y < even(image.rows); ++y)
        for (int x = 0; x < even(image.cols); ++x)
            planes[0].data[y * planes[0].stride + x] =
                byte_of(luma_of(pixel(y, x)) * scale.luma + scale.offset);
    for (int y = 0; y < even(image.rows) / 2; ++y)
        for (int x = 0; x < even(image.cols) / 2; ++x) {
            float blue = 0, red = 0;
            for (const int dy : {0, 1})
                for (const int dx : {0, 1}) {
                    const std::uint8_t* bgr = pixel(2 * y + dy, 2 * x + dx);
                    blue += (float(bgr[0]) - luma_of(bgr)) / (4 * kBlueSpan);
                    red += (float(bgr[2]) - luma_of(bgr)) / (4 * kRedSpan);
                }
            planes[1].data[y * planes[1].stride + x] = byte_of(128.0f + blue * scale.chroma);
            planes[2].data[y * planes[2].stride + x] = byte_of(128.0f + red * scale.chroma);
        }
}

}  // namespace

std::array<std::uint8_t, 256> luma_table(YuvRange range) {
    const Scale scale = scale_of(range);
    std::array<std::uint8_t, 256> table{};
    for (std::size_t i = 0; i < 256; ++i) table[i] = byte_of(float(i) * scale.luma + scale.offset);
    return table;
}

void to_yuv420(const cv::Mat& image, YuvRange range, const std::array<Plane, 3>& planes) {
    if (image.channels() == 1)
        grey_rows(image, range, planes);
    else
        colour_rows(image, range, planes);
}

}  // namespace eventide
