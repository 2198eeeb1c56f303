// What one core can do at most: independent products on registers, and copying memory. No kernel
// can pass it, so that a stage's share of it says how much is left.
#pragma once

#include "src/core/instructions.h"

namespace eventide::bench {

/// A product and its sum count as two operations. 0: not there, or not allowed.
struct Peaks {
    double f32_sse4 = 0, f32_avx2 = 0, f32_avx512 = 0;  ///< GFLOP/s
    double bf16 = 0;                                    ///< GFLOP/s, AVX512_BF16
    double bf16_amx = 0;                                ///< GFLOP/s, AMX
    double int8 = 0;                                    ///< Gop/s, AVX512_VNNI
    double copy_gb_s = 0;                               ///< read and written together, from memory

    double f32() const;  ///< the best of them
};

/// The best of many short runs, in processor time, on the caller's thread: a second in all. Which
/// kinds: those that the kernels may use.
Peaks measure_peaks(Instructions most);

}  // namespace eventide::bench
