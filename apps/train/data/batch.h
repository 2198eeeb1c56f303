// Streams' segments as torch tensors, and a network's pass over one segment.
#pragma once

#include "apps/train/data/data_loader.h"
#include "apps/train/network/losses.h"
#include "apps/train/network/networks.h"
#include "apps/train/network/render.h"

#include <span>
#include <vector>

namespace eventide {

/// What N streams carry from segment to segment.
struct RecurrentState {
    EncoderState state;
    torch::Tensor latent;  ///< of the last event window, [N][D][h][w]
};

RecurrentState empty_recurrent_state(const ModelConfig& config, std::int64_t streams,
                                     std::int64_t height, std::int64_t width,
                                     torch::TensorOptions options);

/// Streams with `fresh` begin empty; gradients do not reach into the segment before.
RecurrentState begin_segment(const RecurrentState& recurrent, const std::vector<bool>& fresh);

struct TrainingBatch {
    std::vector<torch::Tensor> grids;          ///< per frame, [N][4B+1][H][W]
    std::vector<torch::Tensor> teacher_grids;  ///< the same, with a teacher's bins; or empty
    std::vector<torch::Tensor> f;              ///< per rendered frame, [N]
    torch::Tensor truth, weight;               ///< [tasks * N][patch][patch], [tasks * N]
    std::vector<bool> fresh;
};
TrainingBatch to_batch(std::span<const StreamSegment> segments, torch::Device device);

/// Encodes a segment and renders the frames the plan names. `recurrent` goes in as begin_segment()
/// left it and comes out as it is after the segment, still attached.
Images run_segment(const ModelConfig& config, const Parameters& parameters, const SegmentPlan& plan,
                   const TrainingBatch& batch, int patch, RecurrentState& recurrent);

/// [N][C][H][W] of grids [y][x][channel].
torch::Tensor to_torch(std::span<const Array3<float>* const> grids, torch::Device device);

}  // namespace eventide
