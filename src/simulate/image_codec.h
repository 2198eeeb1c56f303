// Lossless code of one grey image: prediction and adaptive Golomb-Rice bits.
#pragma once

#include "src/simulate/scene/textures.h"

#include <cstddef>
#include <span>
#include <vector>

namespace eventide {

std::vector<std::byte> encode_grey(const GreyImage& image);

/// Throws Error (input) where the code ends early.
GreyImage decode_grey(std::span<const std::byte> code, int height, int width);

}  // namespace eventide
