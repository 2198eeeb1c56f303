// What the fused steps share: memory order and types.
#pragma once

#include "apps/train/torch.h"

#include <ATen/Dispatch.h>
#include <ATen/OpMathType.h>

namespace eventide::fused {

inline torch::Tensor packed(const torch::Tensor& x) {
    return x.contiguous(torch::MemoryFormat::ChannelsLast);
}

inline torch::ScalarType wide_of(torch::ScalarType type) {
    return type == torch::kDouble ? torch::kDouble : torch::kFloat;
}

/// Calls `work(T{}, W{})`.
template <typename Work>
void for_type(torch::ScalarType type, const Work& work) {
    AT_DISPATCH_FLOATING_TYPES_AND(torch::kBFloat16, type, "fused",
                                   [&] { work(scalar_t{}, at::opmath_type<scalar_t>{}); });
}

}  // namespace eventide::fused
