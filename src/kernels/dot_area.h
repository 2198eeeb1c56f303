// Many sums of products with the same weights, over overlapping stretches of memory: what every
// convolution and every layer of the network is to the fast kernels.
#pragma once

#include <cstddef>

namespace eventide {

/// Inputs that lie one after the other, in units of 4 bytes: a float32 number, or a pair of bf16
/// numbers. A 3x3 convolution of C channels reads three of them per pixel and source, each of three
/// pixels (channels last); a linear layer reads one.
struct Stretch {
    const void* in = nullptr;  ///< for the first output of the area
    std::ptrdiff_t step = 0;   ///< from one output of a row to the next
    std::ptrdiff_t pitch = 0;  ///< from one row of outputs to the next
    int length = 0;
};

/// out[y][x][o] = act(bias[o] + sum over stretches s, k of in_s[y pitch_s + x step_s + k]
/// weight[s][k][o]). Every output is summed in the order of s and k, whatever the blocking.
struct DotArea {
    const Stretch* stretches = nullptr;
    int count = 0;  ///< of the stretches
    int height = 0, width = 0;
    int outputs = 0;
    int lanes = 0;                 ///< of float32 kernels: dot_lanes(outputs)
    const void* weight = nullptr;  ///< in the order of packed_size()
    const float* bias = nullptr;   ///< [outputs rounded up to whole vectors]
    bool relu = false;
    bool to_bf16 = false;  ///< outputs as bf16 pairs (bf16 kernels alone), else float32
    void* out = nullptr;   ///< an odd number of outputs as bf16 gets a zero beside the last
    std::ptrdiff_t out_step = 0, out_pitch = 0;  ///< between pixels, rows; units of 4 bytes
};

}  // namespace eventide
