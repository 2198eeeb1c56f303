// What bf16_render.cpp and bf16_render_narrow.cpp have in common: vectors of 16 float32 lanes taken
// apart and put together, offsets, and the last layer.
#pragma once

#include "src/kernels/amx_tiles.h"
#include "src/kernels/bf16_vectors.h"
#include "src/kernels/render_kernels.h"

#include <algorithm>
#include <cstring>

namespace eventide::amx {

constexpr int kRun = kTileRows, kBoth = 2 * kRun;  // pixels of a tile, and that go through together

/// Numbers of the even lanes, and of the odd ones, of two vectors one behind the other.
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

/// The k-th unit of a pixel's numbers.
EVENTIDE_AMX_INLINE int unit_at(const std::uint16_t* numbers, int k) {
    int unit;
    std::memcpy(&unit, numbers + std::ptrdiff_t{2} * k, sizeof(unit));
    return unit;
}

/// What the first layer's outputs of a pixel, or of two beside each other, are added to: even ones
/// and odd ones apart (units_plus()).
///
///     one pixel     even    c_0 c_2 .. c_30
///     two of 16     even    c_0 c_2 .. c_14 of pixel p, then of p + 1
struct Offsets {
    __m512 base[2], slope[2];  // of even outputs, of odd ones
    EVENTIDE_AMX_INLINE Offsets(const OffsetRows& r, bool of_two) {
        split(r.base, r.width, of_two, base);
        split(r.slope, r.width, of_two, slope);
    }
    /// As if base held what dx adds.
    EVENTIDE_AMX_INLINE void move(float dx) {
        for (int i = 0; i < 2; ++i) base[i] = at(i, _mm512_set1_ps(dx));
    }
    EVENTIDE_AMX_INLINE __m512 at(int i, __m512 dx) const {
        return _mm512_fmadd_ps(dx, slope[i], base[i]);
    }

private:
    EVENTIDE_AMX_INLINE static void split(const float* from, int width, bool of_two,
                                          __m512 (&to)[2]) {
        const __m512 low = _mm512_maskz_loadu_ps(first_lanes(width), from),
                     high =
                         of_two ? low : _mm512_maskz_loadu_ps(first_lanes(width - 16), from + 16);
        to[0] = _mm512_permutex2var_ps(low, evens(), high);
        to[1] = _mm512_permutex2var_ps(low, odds(), high);
    }
};

/// What the two rows of the last layer add up for pixels, still spread over lanes.
struct PairOfSums {
    __m512 first, second;
};
/// The sums of both groups of pixels, in as many lanes as one group had.
EVENTIDE_AMX_INLINE PairOfSums joined(const PairOfSums& a, const PairOfSums& b) {
    return {add_neighbours(a.first, b.first), add_neighbours(a.second, b.second)};
}

/// products(p) of kCount pixels from p on, each in its share of the lanes; see two_outputs in
/// render_kernels-inl.h.
template <int kCount, typename Products>
EVENTIDE_AMX_INLINE PairOfSums sums_of(const Products& products, int p) {
    if constexpr (kCount == 1) {
        return products(p);
    } else {
        return joined(sums_of<kCount / 2>(products, p),
                      sums_of<kCount / 2>(products, p + kCount / 2));
    }
}

/// mu and log sigma of a run, in 16 lanes: the products of each pixel added up, plus the bias. Only
/// the first `count` are pixels of the frame.
EVENTIDE_AMX_INLINE void put_outputs(const HiddenRows& r, const PairOfSums& sums, int first,
                                     int count) {
    const __mmask16 mask = first_lanes(count);
    _mm512_mask_storeu_ps(r.mu + first, mask,
                          _mm512_add_ps(sums.first, _mm512_set1_ps(r.last_bias[0])));
    _mm512_mask_storeu_ps(r.log_sigma + first, mask,
                          _mm512_add_ps(sums.second, _mm512_set1_ps(r.last_bias[1])));
}

/// put_outputs() for `count` pixels from `first` on; eight(p) gives the sums of eight of them, from
/// the p-th on.
template <typename Eight>
EVENTIDE_AMX_INLINE void put_by_eights(const HiddenRows& r, const Eight& eight, int first,
                                       int count) {
    for (int p = 0; p < count; p += kRun)
        put_outputs(r, joined(eight(p), eight(p + kRun / 2)), first + p, count - p);
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
