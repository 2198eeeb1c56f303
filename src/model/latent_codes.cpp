// See latent_codes.h.
#include "src/model/latent_codes.h"

#include "src/nn/numbers.h"

namespace eventide {

Array3<float> codes_in_float(const LatentCodes& codes, int depth) {
    if (!codes.is_bf16) return codes.values;
    const int height = codes.values.height(), width = codes.values.width();
    Array3<float> floats{height, width, depth};
    pixels_from_bf16(codes.values.values().data(), std::size_t(height) * std::size_t(width), depth,
                     floats.values().data());
    return floats;
}

}  // namespace eventide
