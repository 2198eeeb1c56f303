// Many sums of products with the same weights, over overlapping stretches of memory: what every
// convolution and every layer of the network is to the fast kernels.
#pragma once

#include <cstddef>

namespace eventide {

/// Inputs that lie one after the other, in units of 4 bytes: a float32 number, or a pair of bf16
/// numbers. A 3x3 convolution of C channels reads three of them per pixel and source, each of three
/// pixels (channels last); a linear layer reads one.
///
/// A row of taps of a 3x3 convolution over 8 float32 channels, stride 1. The stretches of outputs
/// beside each other overlap, and are read where they lie:
///
///     in          pixel -1   pixel 0    pixel 1    pixel 2 ...     8 units a pixel
///     output 0    [-------- length 24 -------]
///     output 1               [-------- length 24 -------]          step 8 (stride 2: 16)
///
/// With u units a pixel, stride 1:
///
///     layer                                  stretches of an output    length    step
///     3x3                                    3 a source: rows          3 u       u
///     3x3, two outputs at once               3 a source: rows          4 u       2 u
///     3x3, sources summed up as if one       9 a source: taps          u         u
///     1x1, linear                            1 a source                u         u
struct Stretch {
    const void* in = nullptr;  ///< for the first output of the area
    std::ptrdiff_t step = 0;   ///< from one output of a row to the next
    std::ptrdiff_t pitch = 0;  ///< from one row of outputs to the next
    int length = 0;
};

/// out[y][x][o] = act(bias[o] + sum over stretches s, k of in_s[y pitch_s + x step_s + k]
/// weight[s][k][o]). Every output is summed in the order of s and k,
/// whatever the blocking; within one product AMX has an order of its own.
/// In float32 output o of pixel (y, x) is number y out_pitch + x out_step + o of `out`; as bf16, of
/// which two fill a unit, number 2 (y out_pitch + x out_step) + o.
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
