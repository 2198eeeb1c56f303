// The encoders of docs/model.md as differentiable functions of their parameters and state.
#pragma once

#include "apps/train/network/parameters.h"
#include "src/model/model_config.h"

#include <vector>

namespace eventide {

/// One hidden map per level (thesis: two), float32 [N][C][h][w]; empty before the first frame.
using EncoderState = std::vector<torch::Tensor>;

struct EncodedGrid {
    torch::Tensor latent;  ///< [N][D][H / latent_stride][W / latent_stride], float32
    EncoderState state;
};

/// One event window. `grid` [N][4B+1][H][W] float32, as the binner gives it. Computes in the type
/// of `parameters` (float32, double or bfloat16); states and latent codes stay in float32 (double
/// with double).
EncodedGrid encode(const ModelConfig& config, const Parameters& parameters,
                   const torch::Tensor& grid, const EncoderState& state);

/// The state before the first frame, for grids of this size.
EncoderState empty_state(const ModelConfig& config, std::int64_t streams, std::int64_t height,
                         std::int64_t width, torch::TensorOptions options);

/// A state cut off from its history: the end of a stretch that gradients flow through.
EncoderState detach(const EncoderState& state);

/// bfloat16's gradient of relu is slow in libtorch 1.13; that of a leaky relu of slope 0 is not.
torch::Tensor rectify(const torch::Tensor& x);

}  // namespace eventide
