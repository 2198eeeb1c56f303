// Floats to bytes, and the four ways of showing sigma in one image.
#include "pipeline/sinks/draw_frame.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

namespace eventide {

namespace {

/// Written so that NaN compares false and ends at 0, and so that compilers turn it into vectors.
template <typename T>
void quantise(std::span<const float> values, float white, std::span<T> into, float top) {
    const float scale = top / white;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const float scaled = values[i] * scale;
        const float low = scaled > 0.0f ? scaled : 0.0f;
        const float clamped = low < top ? low : top;
        into[i] = T(clamped + 0.5f);
    }
}

std::span<std::uint8_t> row_of(cv::Mat& image, int y) {
    return {image.ptr<std::uint8_t>(y), std::size_t(image.cols) * image.elemSize()};
}

/// sigma of one row as 0..255; zeros where the frame has none.
void sigma_row(const Frame& frame, int y, float white, std::span<std::uint8_t> into) {
    if (frame.sigma.empty())
        std::ranges::fill(into, std::uint8_t{0});
    else
        to_grey8(frame.sigma.row(y), white, into);
}

/// a b / 255, rounded.
std::uint8_t scaled(int a, int b) {
    return std::uint8_t((a * b + 127) / 255);
}

/// Calls put(pixel, grey, doubt) for every pixel of `image`, with intensity and sigma as 0..255.
template <typename Put>
void draw_pixels(const Frame& frame, float sigma_white, cv::Mat& image, const Put& put) {
    const auto width = std::size_t(frame.intensity.width());
    std::vector<std::uint8_t> grey(width, 0), doubt(width, 0);
    for (int y = 0; y < frame.intensity.height(); ++y) {
        to_grey8(frame.intensity.row(y), 1.0f, grey);
        sigma_row(frame, y, sigma_white, doubt);
        std::uint8_t* pixel = row_of(image, y).data();
        for (std::size_t x = 0; x < width; ++x, pixel += image.elemSize())
            put(pixel, grey[x], doubt[x]);
    }
}

void draw_overlay(std::uint8_t* bgr, std::uint8_t grey, std::uint8_t doubt) {
    const std::uint8_t kept = scaled(grey, 255 - doubt);
    bgr[0] = bgr[1] = kept;
    bgr[2] = std::uint8_t(kept + doubt);
}

void draw_alpha(std::uint8_t* bgra, std::uint8_t grey, std::uint8_t doubt) {
    bgra[0] = bgra[1] = bgra[2] = grey;
    bgra[3] = std::uint8_t(255 - doubt);
}

}  // namespace

std::string_view name_of(Uncertainty uncertainty) {
    constexpr std::array<std::string_view, 6> kNames{"auto", "none",  "separate",
                                                     "side", "alpha", "overlay"};
    return kNames[std::size_t(uncertainty)];
}

void to_grey8(std::span<const float> values, float white, std::span<std::uint8_t> into) {
    quantise(values, white, into, 255.0f);
}

void to_grey16(std::span<const float> values, float white, std::span<std::uint16_t> into) {
    quantise(values, white, into, 65535.0f);
}

void draw(const Frame& frame, Uncertainty how, float sigma_white, cv::Mat& image) {
    const int height = frame.intensity.height(), width = frame.intensity.width();
    switch (how) {
        case Uncertainty::overlay:
            image.create(height, width, CV_8UC3);
            return draw_pixels(frame, sigma_white, image, draw_overlay);
        case Uncertainty::alpha:
            image.create(height, width, CV_8UC4);
            return draw_pixels(frame, sigma_white, image, draw_alpha);
        case Uncertainty::side:
            image.create(height, 2 * width, CV_8UC1);
            for (int y = 0; y < height; ++y) {
                const auto row = row_of(image, y);
                to_grey8(frame.intensity.row(y), 1.0f, row.first(std::size_t(width)));
                sigma_row(frame, y, sigma_white, row.last(std::size_t(width)));
            }
            return;
        case Uncertainty::automatic:
        case Uncertainty::none:
        case Uncertainty::separate:
            image.create(height, width, CV_8UC1);
            for (int y = 0; y < height; ++y)
                to_grey8(frame.intensity.row(y), 1.0f, row_of(image, y));
    }
}

void draw_events(const Frame& frame, cv::Mat& image) {
    if (frame.event_preview.empty()) return image.release();
    image.create(frame.event_preview.height(), frame.event_preview.width(), CV_8UC3);
    const cv::Vec3b on{60, 60, 220}, off{200, 90, 40}, none{255, 255, 255};
    for (int y = 0; y < image.rows; ++y) {
        const auto sums = frame.event_preview.row(y);
        auto* row = image.ptr<cv::Vec3b>(y);
        for (std::size_t x = 0; x < sums.size(); ++x)
            row[x] = sums[x] > 0 ? on : sums[x] < 0 ? off : none;
    }
}

void draw_events_beside(const Frame& frame, cv::Mat& image) {
    cv::Mat events, scaled, coloured = image;
    draw_events(frame, events);
    if (events.empty()) return;
    cv::resize(events, scaled, {frame.intensity.width(), frame.intensity.height()}, 0, 0,
               cv::INTER_NEAREST);
    if (image.channels() == 1) cv::cvtColor(image, coloured, cv::COLOR_GRAY2BGR);
    if (image.channels() == 4) cv::cvtColor(image, coloured, cv::COLOR_BGRA2BGR);
    cv::hconcat(scaled, coloured, image);
}

void draw_sigma(const Frame& frame, float sigma_white, cv::Mat& image) {
    image.create(frame.intensity.height(), frame.intensity.width(), CV_8UC1);
    for (int y = 0; y < image.rows; ++y) sigma_row(frame, y, sigma_white, row_of(image, y));
}

}  // namespace eventide
