// Codes of a latent map as float32, for those who are not layers.
#pragma once

#include "src/core/frame_data.h"

namespace eventide {

/// [y][x][depth]; `depth` is D of the model they were made by.
Array3<float> codes_in_float(const LatentCodes& codes, int depth);

}  // namespace eventide
