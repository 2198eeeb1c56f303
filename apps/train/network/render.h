// The implicit renderer of docs/model.md as a differentiable function: patches and single points.
#pragma once

#include "apps/train/network/parameters.h"
#include "src/model/model_config.h"

#include <vector>

namespace eventide {

/// Where the samples of a patch lie, in latent pixels: rows x columns.
struct PatchGrid {
    std::vector<double> y, x;
};

/// `size` x `size` points over [y0, y0 + span] x [x0, x0 + span], corners included.
PatchGrid patch_grid(double y0, double x0, double span, int size);

/// One image for each of the N streams: the codes around event window k and the instant asked for.
struct RenderTask {
    torch::Tensor previous, current, next, after;  ///< z_{k-1} .. z_{k+2}, [N][D][h][w]; undefined
                                                   ///< where not known (or before the first)
    torch::Tensor f;                               ///< [N], place in the event window, (0, 1]
    torch::Tensor before = {};  ///< z_{k-2}, for a live edge that fades; undefined: it does not
};

struct Rendered {
    torch::Tensor mu, log_sigma;  ///< [N * tasks][rows][columns]; of stream n and task i at i N + n
};

/// All tasks over the same points, in one go. log_sigma is clamped but not yet scaled.
Rendered render(const ModelConfig& config, const Parameters& parameters,
                const std::vector<RenderTask>& tasks, const PatchGrid& points);

}  // namespace eventide
