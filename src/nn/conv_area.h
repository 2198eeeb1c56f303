// Where a convolution of the fast engine reads and writes.
#pragma once

#include <array>
#include <cstddef>

namespace eventide {

/// One of the maps whose channels a convolution reads side by side: numbers of the layer's kind,
/// beginning with the pixel up and left of the first output's centre.
struct ConvSource {
    const void* in = nullptr;
    std::ptrdiff_t pitch = 0;  ///< units from one row to the next
};

/// Where a convolution reads and writes.
struct ConvArea {
    static constexpr int kMaxSources = 3;
    std::array<ConvSource, kMaxSources> in{};
    void* out = nullptr;           ///< pixels of a row one after the other
    std::ptrdiff_t out_pitch = 0;  ///< units between rows
    bool to_bf16 = false;          ///< outputs of the kind that layers read, else float32
    int height = 0, width = 0;     ///< outputs
};

}  // namespace eventide
