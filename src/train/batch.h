// Lanes' windows as torch tensors, and a network's pass over one window.
#pragma once

#include "src/train/data.h"
#include "src/train/losses.h"
#include "src/train/networks.h"
#include "src/train/render.h"

#include <span>
#include <vector>

namespace eventide {

/// What N lanes carry from window to window.
struct Memory {
    EncoderState state;
    torch::Tensor latent;  ///< of the last event frame, [N][D][h][w]
};

Memory empty_memory(const ModelConfig& config, std::int64_t lanes, std::int64_t height,
                    std::int64_t width, torch::TensorOptions options);

/// Lanes with `fresh` begin empty; gradients do not reach into the window before.
Memory begin_window(const Memory& memory, const std::vector<bool>& fresh);

struct TrainingBatch {
    std::vector<torch::Tensor> grids;  ///< per frame, [N][4B+1][H][W]
    std::vector<torch::Tensor> f;      ///< per rendered frame, [N]
    torch::Tensor truth, weight;       ///< [tasks * N][patch][patch], [tasks * N]
    std::vector<bool> fresh;
};
TrainingBatch to_batch(std::span<const LaneWindow> windows, torch::Device device);

/// Encodes a window and renders the frames the plan names. `memory` goes in as begin_window() left
/// it and comes out as it is after the window, still attached.
Pictures run_window(const ModelConfig& config, const Parameters& parameters, const WindowPlan& plan,
                    const TrainingBatch& batch, int patch, Memory& memory);

/// [N][C][H][W] of grids [y][x][channel].
torch::Tensor to_torch(std::span<const Array3<float>* const> grids, torch::Device device);

}  // namespace eventide
