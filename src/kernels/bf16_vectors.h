// What files that are compiled for AVX512_BF16 function by function have in common.
#pragma once

#include <immintrin.h>

#include <algorithm>
#include <cstdint>

#define EVENTIDE_BF16 __attribute__((target("avx512f,avx512bw,avx512vl,avx512dq,avx512bf16")))
#define EVENTIDE_BF16_INLINE EVENTIDE_BF16 __attribute__((always_inline)) inline

namespace eventide {

/// The first n of 16 lanes; none where n is below 1, all where it is above 15.
EVENTIDE_BF16_INLINE __mmask16 first_lanes(int n) {
    return __mmask16(n >= 16 ? 0xffffU : (1U << unsigned(std::max(n, 0))) - 1U);
}

/// 16 bf16 numbers as float32, zeros where the mask has none; those are not read.
EVENTIDE_BF16_INLINE __m512 widened(const std::uint16_t* from, __mmask16 mask) {
    return _mm512_castsi512_ps(
        _mm512_slli_epi32(_mm512_cvtepu16_epi32(_mm256_maskz_loadu_epi16(mask, from)), 16));
}

}  // namespace eventide
