#include "apps/train/fused/fused.h"
#include "apps/train/fused/fused_types.h"
#include "apps/train/network/networks.h"

namespace eventide::fused::composed {
namespace {

torch::Tensor up2_along(const torch::Tensor& a, int dim, std::int64_t size) {
    const std::int64_t n = a.size(dim);
    const auto next = torch::cat({a.narrow(dim, 1, n - 1), a.narrow(dim, n - 1, 1)}, dim);
    return torch::stack({a, (a + next) * 0.5}, dim + 1).flatten(dim, dim + 1).narrow(dim, 0, size);
}

}  // namespace

torch::Tensor compressed(const torch::Tensor& grid, torch::ScalarType type) {
    const torch::Tensor wide = grid.to(wide_of(type));
    return (wide.sign() * wide.abs().log1p()).to(type);
}

torch::Tensor reset_state(const torch::Tensor& gates, const torch::Tensor& h) {
    return gates.chunk(2, 1)[1] * h.to(gates.scalar_type());
}

torch::Tensor update_state(const torch::Tensor& gates, const torch::Tensor& candidate,
                           const torch::Tensor& h, const torch::Tensor& mask) {
    const auto type = h.scalar_type();
    const torch::Tensor step = gates.chunk(2, 1)[0].to(type) * (candidate.to(type) - h);
    return h + (mask.defined() ? mask * step : step);
}

torch::Tensor up2(const torch::Tensor& a, std::int64_t height, std::int64_t width) {
    return up2_along(up2_along(a, 2, height), 3, width)
        .contiguous(torch::MemoryFormat::ChannelsLast);
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
    const auto points =
        first.index_select(2, index(y)).index_select(3, index(x)).to(options.dtype());
    const auto sum = points + dt.view({-1, 1, 1, 1}) * column(0) +
                     offset(x).view({1, 1, 1, -1}) * column(1) +
                     offset(y).view({1, 1, -1, 1}) * column(2);
    return rectify(sum.to(first.scalar_type()).contiguous(torch::MemoryFormat::ChannelsLast));
}

}  // namespace eventide::fused::composed
