// Vectors of 16 float32 lanes as bf16_render*.cpp take them apart and put them together.
#pragma once

#include "src/kernels/amx_tiles.h"

#include <algorithm>

namespace eventide::amx {

EVENTIDE_AMX_INLINE __mmask16 first_lanes(int n) {
    return __mmask16(n >= 16 ? 0xffffU : (1U << unsigned(std::max(n, 0))) - 1U);
}
/// Of two vectors, one behind the other: the even lanes, the odd ones.
EVENTIDE_AMX_INLINE __m512i evens() {
    return _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
}
EVENTIDE_AMX_INLINE __m512i odds() {
    return _mm512_setr_epi32(1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31);
}
/// Neighbouring lanes of a, then of b, added to each other.
EVENTIDE_AMX_INLINE __m512 add_neighbours(__m512 a, __m512 b) {
    return _mm512_add_ps(_mm512_permutex2var_ps(a, evens(), b),
                         _mm512_permutex2var_ps(a, odds(), b));
}

/// Units of two bf16 numbers, + what is given for the first and the second of each, relu, and as
/// units again. A number is float32 by a shift or a mask alone.
///
///     unit i    c_2i | c_2i+1        even, odd: lane i for c_2i, for c_2i+1
EVENTIDE_AMX_INLINE __m512i units_plus(__m512i units, __m512 even, __m512 odd) {
    const __m512i high = _mm512_set1_epi32(int(0xffff0000U));
    // Number i of the evens, then number i of the odds.
    const __m512i together =
        _mm512_set_epi16(31, 15, 30, 14, 29, 13, 28, 12, 27, 11, 26, 10, 25, 9, 24, 8, 23, 7, 22, 6,
                         21, 5, 20, 4, 19, 3, 18, 2, 17, 1, 16, 0);
    const __m512 zero = _mm512_setzero_ps();
    even = _mm512_max_ps(_mm512_add_ps((__m512)_mm512_slli_epi32(units, 16), even), zero);
    odd = _mm512_max_ps(_mm512_add_ps((__m512)_mm512_and_si512(units, high), odd), zero);
    return _mm512_permutexvar_epi16(together, (__m512i)_mm512_cvtne2ps_pbh(odd, even));
}

/// Whether all of `n` numbers are one: pixels lie at the same place beside their samples where
/// frames are as large as the sensor.
EVENTIDE_AMX_INLINE bool all_same(const float* numbers, int n) {
    const __m512 first = _mm512_set1_ps(numbers[0]);
    for (int i = 0; i < n; i += 16) {
        const __mmask16 mask = first_lanes(n - i);
        if (_mm512_mask_cmp_ps_mask(mask, _mm512_maskz_loadu_ps(mask, numbers + i), first,
                                    _CMP_EQ_OQ) != mask)
            return false;
    }
    return true;
}

}  // namespace eventide::amx
