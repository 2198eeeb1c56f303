// Frames as plain numbers, intensity and sigma in one of four arrangements.
#pragma once

#include "pipeline/sinks/draw_frame.h"

#include <cstddef>
#include <vector>

namespace eventide {

struct RawLayout {
    Uncertainty uncertainty = Uncertainty::none;  ///< none, separate, side or alpha
    float sigma_white = kSigmaWhite;              ///< not used for sigma as float
};

/// Appends one frame, little endian, without a header. T is uint8_t, uint16_t or float. A frame
/// without sigma gives zeros where sigma is asked for.
template <typename T>
void append_pixels(const Frame& frame, const RawLayout& layout, std::vector<std::byte>& into);

}  // namespace eventide
