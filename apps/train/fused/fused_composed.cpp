#include "apps/train/fused/fused.h"
#include "apps/train/fused/fused_types.h"
#include "apps/train/network/networks.h"

namespace eventide::fused::composed {
namespace {

/// The last row or column twice.
torch::Tensor with_last_twice(const torch::Tensor& a, int dim) {
    return torch::cat({a, a.narrow(dim, a.size(dim) - 1, 1)}, dim);
}

}  // namespace

torch::Tensor compressed(const torch::Tensor& grid, torch::ScalarType type) {
    const torch::Tensor wide = grid.to(wide_of(type));
    return torch::copysign(wide.abs().log1p(), wide).to(type);
}

torch::Tensor reset_state(const torch::Tensor& gates, const torch::Tensor& h) {
    return gates.chunk(2, 1)[1] * h.to(gates.scalar_type());
}

torch::Tensor update_state(const torch::Tensor& gates, const torch::Tensor& candidate,
                           const torch::Tensor& h, const torch::Tensor& mask) {
    // Wide times narrow is wide, without a copy of its own.
    const torch::Tensor update = gates.narrow(1, 0, h.size(1));
    const torch::Tensor share = mask.defined() ? mask * update : update.to(h.scalar_type());
    return torch::lerp(h, candidate.to(h.scalar_type()), share);
}

torch::Tensor up2(const torch::Tensor& a, std::int64_t height, std::int64_t width) {
    // Each pixel four times, and the means of neighbours among them.
    const torch::Tensor four =
        torch::upsample_nearest2d(with_last_twice(with_last_twice(a, 2), 3), {}, {{2.0, 2.0}});
    return torch::avg_pool2d(four, 2, 1).narrow(2, 0, height).narrow(3, 0, width);
}

torch::Tensor offset_layer(const torch::Tensor& first, const torch::Tensor& dt,
                           const torch::Tensor& offsets, const Axis& y, const Axis& x) {
    const auto options = first.options().dtype(wide_of(first.scalar_type()));
    const auto index = [&](const Axis& axis) {
        return torch::tensor(axis.index).to(first.device());
    };
    const auto offset = [&](const Axis& axis) {
        return torch::tensor(axis.offset, torch::kDouble).to(options);
    };
    const auto column = [&](int k) { return offsets.select(1, k).to(options).view({1, -1, 1, 1}); };
    const auto points = first.index_select(2, index(y)).index_select(3, index(x));
    const auto of_row =
        dt.view({-1, 1, 1, 1}) * column(0) + offset(y).view({1, 1, -1, 1}) * column(2);
    const auto sum = points + of_row + offset(x).view({1, 1, 1, -1}) * column(1);
    return rectify(sum.to(first.scalar_type()).contiguous(torch::MemoryFormat::ChannelsLast));
}

}  // namespace eventide::fused::composed
