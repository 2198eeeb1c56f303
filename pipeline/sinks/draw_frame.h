// Frames as people see them: 8 bits, with sigma beside, over or behind the intensity.
#pragma once

#include "src/core/frame_data.h"

#include <opencv2/core.hpp>

#include <cstdint>
#include <span>
#include <string_view>

namespace eventide {

/// How sigma is shown. Each sink's header says which it can do.
enum class Uncertainty {
    automatic,  ///< what the sink does best: the folder writes it apart, the others leave it out
    none,       ///< nowhere
    separate,   ///< a second image, file or plane
    side,       ///< right of the intensity
    alpha,      ///< as transparency: opaque where certain, clear where sigma >= sigma_white
    overlay     ///< as red over the intensity, full red where sigma >= sigma_white
};

std::string_view name_of(Uncertainty uncertainty);

/// The sigma that is shown as white (or full red, or clear), in units of intensity. 8-bit value =
/// round(255 min(1, sigma / sigma_white)).
constexpr float kSigmaWhite = 0.3f;

inline bool is_coloured(const Frame& frame) {
    return !frame.colour[0].empty();
}

/// 8-bit value = round(255 v / white), clamped to 0..255; NaN becomes 0.
void to_grey8(std::span<const float> values, float white, std::span<std::uint8_t> into);

/// 16-bit value = round(65535 v / white), clamped to 0..65535; NaN becomes 0.
void to_grey16(std::span<const float> values, float white, std::span<std::uint16_t> into);

/// Draws a frame into `image` (made when its size or type differs): none, separate and automatic
/// give the intensity (CV_8UC1), side both (CV_8UC1, twice as wide), alpha CV_8UC4 and overlay
/// CV_8UC3, both in OpenCV's order (BGR); a frame in colour is CV_8UC3 where a grey one is CV_8UC1.
/// A frame without sigma is drawn as if sigma were 0.
void draw(const Frame& frame, Uncertainty how, float sigma_white, cv::Mat& image);

/// Draws Frame::event_preview: CV_8UC3, red where ON events outweigh, blue where OFF, white else.
/// Leaves `image` empty where the frame has none.
void draw_events(const Frame& frame, cv::Mat& image);

/// What frames show of the sensor, in shares of its sides: events and reference images are of all
/// of it.
struct ShownPart {
    double left = 0, top = 0, width = 1, height = 1;
};

/// `part` of an image of the whole sensor, sharing its pixels: at least one each way.
cv::Mat part_of(const cv::Mat& sensor, const ShownPart& part);

/// Puts the frame's events, of the part it shows, left of `image`, what draw() made of the frame:
/// as colours and at the intensity's size, so that single events stay visible. `image`, grey or
/// colour without transparency, becomes CV_8UC3. Where the frame has no Frame::event_preview
/// nothing changes.
void draw_events_beside(const Frame& frame, const ShownPart& part, cv::Mat& image);

/// Draws sigma alone: CV_8UC1.
void draw_sigma(const Frame& frame, float sigma_white, cv::Mat& image);

}  // namespace eventide
