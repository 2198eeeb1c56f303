// Steps of the networks that libtorch takes in a dozen passes over memory, here in one each way.
//
// Gradients included. Types: T is that of the arithmetic (float, double, bfloat16), W the wider one
// of states and sums (double for double, else float). Maps come out channels-last. On a device
// other than the CPU the same is computed by torch's own operations.
#pragma once

#include "apps/train/torch.h"

#include <array>
#include <cstdint>
#include <vector>

namespace eventide::fused {

/// r.h in T: what the candidate sees of the state. `gates` [N][2C][h][w] in T, update gates first
/// and reset gates second, after the sigmoid; h [N][C][h][w] in W.
torch::Tensor reset_state(const torch::Tensor& gates, const torch::Tensor& h);

/// h + m.u.(c - h) in W. `gates` as above, or the update gates alone; c [N][C][h][w] in T; mask
/// [N][1][h][w] in W, or undefined for 1.
torch::Tensor update_state(const torch::Tensor& gates, const torch::Tensor& candidate,
                           const torch::Tensor& h, const torch::Tensor& mask);

/// T(v) = sign(v) log1p(|v|) of a voxel grid (no gradient), in `type`.
torch::Tensor compressed(const torch::Tensor& grid, torch::ScalarType type);

/// Twice the size: out[2 j] = a[j], out[2 j + 1] = (a[j] + a[min(j + 1, last)]) / 2 along both
/// axes, cut to height x width (each 2 n or 2 n - 1).
torch::Tensor up2(const torch::Tensor& a, std::int64_t height, std::int64_t width);

/// Points along one axis: the sample that each takes, and where it lies from there (px).
struct Axis {
    std::vector<std::int64_t> index;
    std::vector<double> offset;
};

/// The renderer's first layer at rows x columns of points, rectified, in T:
/// max(0, first[m][:, y.index, x.index] + dt[m] o_0 + x.offset o_1 + y.offset o_2).
/// first [M][H][h][w] in T; dt [M] in W, without gradient; offsets o [H][3] in T.
torch::Tensor offset_layer(const torch::Tensor& first, const torch::Tensor& dt,
                           const torch::Tensor& offsets, const Axis& y, const Axis& x);

/// Points along one axis with the weight each gives its sample.
struct WeightedAxis : Axis {
    std::vector<double> weight;
};

/// How outputs at samples become an image.
struct MemberBlend : torch::CustomClassHolder {
    std::array<WeightedAxis, 2> y, x;  ///< the lower and the upper neighbour
    std::vector<double> dt, weight;    ///< per map: offset and weight in time
    double log_sigma_min = 0, log_sigma_max = 0;
    bool squares = false;  ///< blends sigma^2 + mu^2 instead of ln sigma
};

/// Whether members() takes these layers: on the CPU, two hidden ones of one width it knows.
bool members_fused(const torch::Tensor& first, const std::vector<torch::Tensor>& weights);

/// offset_layer, the layers behind it, and the weighted sum over the four neighbours in space:
/// [M][2][rows][columns] in W, mu and ln sigma (or the second moment). `weights` and `biases` are
/// those of all linear layers, of which the first is already in `first`.
torch::Tensor members(const torch::Tensor& first, const torch::Tensor& offsets,
                      const std::vector<torch::Tensor>& weights,
                      const std::vector<torch::Tensor>& biases,
                      const c10::intrusive_ptr<MemberBlend>& blend);

/// The same by torch's own operations: for other devices, and to judge the above by.
namespace composed {
torch::Tensor compressed(const torch::Tensor& grid, torch::ScalarType type);
torch::Tensor reset_state(const torch::Tensor& gates, const torch::Tensor& h);
torch::Tensor update_state(const torch::Tensor& gates, const torch::Tensor& candidate,
                           const torch::Tensor& h, const torch::Tensor& mask);
torch::Tensor up2(const torch::Tensor& a, std::int64_t height, std::int64_t width);
torch::Tensor offset_layer(const torch::Tensor& first, const torch::Tensor& dt,
                           const torch::Tensor& offsets, const Axis& y, const Axis& x);
}  // namespace composed

}  // namespace eventide::fused
