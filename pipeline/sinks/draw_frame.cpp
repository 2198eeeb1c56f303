// Floats to bytes, and the four ways of showing sigma in one image.
#include "pipeline/sinks/draw_frame.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
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
        into[i] = T(clamped + 0.5f);  // NOLINT(bugprone-incorrect-roundings): never below 0
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

/// Blue, green and red of one row, 0..255: all the intensity where the frame is grey.
struct ColourRow {
    explicit ColourRow(std::size_t width) {
        for (auto& channel : bgr) channel.resize(width);
    }
    void read(const Frame& frame, int y) {
        for (std::size_t c = 0; c < bgr.size(); ++c)
            to_grey8(frame.colour[c].empty() ? frame.intensity.row(y) : frame.colour[c].row(y),
                     1.0f, bgr[c]);
    }
    std::array<std::vector<std::uint8_t>, 3> bgr;
};

/// Calls put(pixel, colour, doubt) for every pixel of `image`, with all as 0..255.
template <typename Put>
void draw_pixels(const Frame& frame, float sigma_white, cv::Mat& image, const Put& put) {
    const auto width = std::size_t(frame.intensity.width());
    ColourRow colour{width};
    std::vector<std::uint8_t> doubt(width, 0);
    for (int y = 0; y < frame.intensity.height(); ++y) {
        colour.read(frame, y);
        sigma_row(frame, y, sigma_white, doubt);
        std::uint8_t* pixel = row_of(image, y).data();
        for (std::size_t x = 0; x < width; ++x, pixel += image.elemSize())
            put(pixel, {colour.bgr[0][x], colour.bgr[1][x], colour.bgr[2][x]}, doubt[x]);
    }
}

using Bgr = std::array<std::uint8_t, 3>;

void draw_overlay(std::uint8_t* bgr, const Bgr& colour, std::uint8_t doubt) {
    for (std::size_t c = 0; c < 3; ++c) bgr[c] = scaled(colour[c], 255 - doubt);
    bgr[2] = std::uint8_t(bgr[2] + doubt);
}

void draw_alpha(std::uint8_t* bgra, const Bgr& colour, std::uint8_t doubt) {
    std::ranges::copy(colour, bgra);
    bgra[3] = std::uint8_t(255 - doubt);
}

void draw_colour(std::uint8_t* bgr, const Bgr& colour, std::uint8_t) {
    std::ranges::copy(colour, bgr);
}

/// Colour left, sigma as grey right of it.
void draw_colour_beside_sigma(const Frame& frame, float sigma_white, cv::Mat& image) {
    cv::Mat colour(frame.intensity.height(), frame.intensity.width(), CV_8UC3), sigma, grey;
    draw_pixels(frame, sigma_white, colour, draw_colour);
    draw_sigma(frame, sigma_white, grey);
    cv::cvtColor(grey, sigma, cv::COLOR_GRAY2BGR);
    cv::hconcat(colour, sigma, image);
}

}  // namespace

std::string_view name_of(Uncertainty uncertainty) {
    switch (uncertainty) {
        case Uncertainty::none:
            return "none";
        case Uncertainty::separate:
            return "separate";
        case Uncertainty::side:
            return "side";
        case Uncertainty::alpha:
            return "alpha";
        case Uncertainty::overlay:
            return "overlay";
        case Uncertainty::automatic:
            break;
    }
    return "auto";
}

void to_grey8(std::span<const float> values, float white, std::span<std::uint8_t> into) {
    quantise(values, white, into, 255.0f);
}

void to_grey16(std::span<const float> values, float white, std::span<std::uint16_t> into) {
    quantise(values, white, into, 65535.0f);
}

void draw(const Frame& frame, Uncertainty how, float sigma_white, cv::Mat& image) {
    const int height = frame.intensity.height(), width = frame.intensity.width();
    const bool coloured = is_coloured(frame);
    switch (how) {
        case Uncertainty::overlay:
            image.create(height, width, CV_8UC3);
            return draw_pixels(frame, sigma_white, image, draw_overlay);
        case Uncertainty::alpha:
            image.create(height, width, CV_8UC4);
            return draw_pixels(frame, sigma_white, image, draw_alpha);
        case Uncertainty::side:
            if (coloured) return draw_colour_beside_sigma(frame, sigma_white, image);
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
            image.create(height, width, coloured ? CV_8UC3 : CV_8UC1);
            if (coloured) return draw_pixels(frame, sigma_white, image, draw_colour);
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

cv::Mat part_of(const cv::Mat& sensor, const ShownPart& part) {
    const auto cut = [](double from, double length, int side) {
        const int begin = std::clamp(int(std::lround(from * side)), 0, side - 1);
        const int end = std::clamp(int(std::lround((from + length) * side)), begin + 1, side);
        return cv::Range{begin, end};
    };
    return sensor(cut(part.top, part.height, sensor.rows), cut(part.left, part.width, sensor.cols));
}

void draw_events_beside(const Frame& frame, const ShownPart& part, cv::Mat& image) {
    cv::Mat events, scaled, coloured = image;
    draw_events(frame, events);
    if (events.empty()) return;
    cv::resize(part_of(events, part), scaled, {frame.intensity.width(), frame.intensity.height()},
               0, 0, cv::INTER_NEAREST);
    if (image.channels() == 1) cv::cvtColor(image, coloured, cv::COLOR_GRAY2BGR);
    cv::hconcat(scaled, coloured, image);
}

void draw_sigma(const Frame& frame, float sigma_white, cv::Mat& image) {
    image.create(frame.intensity.height(), frame.intensity.width(), CV_8UC1);
    for (int y = 0; y < image.rows; ++y) sigma_row(frame, y, sigma_white, row_of(image, y));
}

}  // namespace eventide
