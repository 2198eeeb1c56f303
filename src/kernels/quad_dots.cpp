// See quad_dots.h. Intrinsics, compiled for their instruction set function by function.
#include "src/kernels/quad_dots.h"

#if defined(__x86_64__)
#include <immintrin.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <utility>

#define EVENTIDE_QUADS_CAN "avx512f,avx512bw,avx512vl,avx512dq,avx512bf16"
#if defined(__clang__)  // which does not know this preference, and does not need it
#define EVENTIDE_QUADS __attribute__((target(EVENTIDE_QUADS_CAN)))
#else
#define EVENTIDE_QUADS __attribute__((target(EVENTIDE_QUADS_CAN ",prefer-vector-width=512")))
#endif
#define EVENTIDE_QUADS_INLINE EVENTIDE_QUADS __attribute__((always_inline)) inline
#endif

namespace eventide::avx512 {

bool takes_quads(const DotArea& r) {
    if ((r.outputs != 8 && r.outputs != 16) || r.width < 4) return false;
    if (r.out_step != (r.to_bf16 ? r.outputs / 2 : r.outputs)) return false;
    for (int s = 0; s < r.count; ++s)
        if (r.stretches[s].length % 4 != 0 ||
            (r.stretches[s].step == 8 && r.stretches[s].length % 8 != 0))
            return false;
    return true;
}

#if defined(__x86_64__)
namespace {

/// One register for four pixels of so many units each.
struct F32 {
    EVENTIDE_QUADS_INLINE static __m512 add(__m512 sum, __m512i in, __m512i weight) {
        return _mm512_fmadd_ps((__m512)in, (__m512)weight, sum);
    }
};
struct Bf16 {
    EVENTIDE_QUADS_INLINE static __m512 add(__m512 sum, __m512i in, __m512i weight) {
        return _mm512_dpbf16_ps(sum, (__m512bh)in, (__m512bh)weight);
    }
};

EVENTIDE_QUADS_INLINE __m512i four_times(const void* from) {
    return _mm512_broadcast_i32x4(_mm_loadu_si128(static_cast<const __m128i*>(from)));
}
EVENTIDE_QUADS_INLINE __m512i whole(const std::uint32_t* from) {
    return _mm512_loadu_si512(from);
}
EVENTIDE_QUADS_INLINE __m128i quad(const std::uint32_t* from) {
    return _mm_loadu_si128(reinterpret_cast<const __m128i*>(from));
}

/// The four quads of a register, of pixels of two quads each (8 units, InTwos):
///
///     in memory     p0 q0 | p0 q1 | p1 q0 | p1 q1      behind them p2 q0 | p2 q1 | p3 q0 | ...
///     k = 0         p0 q0 | p1 q0 | p2 q0 | p3 q0
///     k = 4         p0 q1 | p1 q1 | p2 q1 | p3 q1      from the same two loads
///     k = 8         p1 q0 | p2 q0 | p3 q0 | p4 q0      a stretch goes on with the next pixel
///
/// Quad `k / 4` of each of four pixels that are `step` units apart.
struct Beside {  // 4 units
    EVENTIDE_QUADS_INLINE static __m512i load(const std::uint32_t* from, std::ptrdiff_t, int k) {
        return whole(from + k);
    }
};
struct InTwos {  // 8 units; of an odd quad the one before is read, too, so that none past the last
    EVENTIDE_QUADS_INLINE static __m512i load(const std::uint32_t* from, std::ptrdiff_t, int k) {
        const __m512i even = _mm512_setr_epi64(0, 1, 4, 5, 8, 9, 12, 13),
                      odd = _mm512_setr_epi64(2, 3, 6, 7, 10, 11, 14, 15);
        const bool is_odd = k % 8 != 0;
        const std::uint32_t* at = from + k - (is_odd ? 4 : 0);
        return _mm512_permutex2var_epi64(whole(at), is_odd ? odd : even, whole(at + 16));
    }
};
// Any step: a load for each pixel.
struct Apart {
    EVENTIDE_QUADS_INLINE static __m512i load(const std::uint32_t* from, std::ptrdiff_t step,
                                              int k) {
        const std::uint32_t* at = from + k;
        const __m256i a = _mm256_inserti128_si256(_mm256_castsi128_si256(quad(at)), quad(at + step),
                                                  1),
                      b = _mm256_inserti128_si256(_mm256_castsi128_si256(quad(at + 2 * step)),
                                                  quad(at + 3 * step), 1);
        return _mm512_inserti64x4(_mm512_castsi256_si512(a), b, 1);
    }
};

/// kGroups x 4 pixels x kQuads x 4 outputs.
/// Of 8 outputs (2 quads) and 8 groups 16 sums, 8 quads of input, 2 of weights and 1 unit that is
/// spread take 27 of 32 registers; of 16 outputs and 5 groups 20 + 5 + 4 + 1 = 30.
///
///     weights       unit 0: w0 .. w3 | w4 .. w7    unit 1: w0 .. w3 | w4 .. w7    8 outputs
///     sums[g][o]    outputs 4 o to 4 o + 3 of pixels 4 g to 4 g + 3
///
/// Each sum is added up unit by unit, as in dot_block() of vector_dots-inl.h, to the same bits.
template <class Number, int kGroups, int kQuads>
struct Block {
    __m512 sums[kGroups][kQuads];
    std::ptrdiff_t at[kGroups];  // pixel of a group's first
    const std::uint32_t* weight;

    EVENTIDE_QUADS_INLINE void start(const DotArea& r, int x, int back) {
#pragma GCC unroll 8
        for (int g = 0; g < kGroups; ++g) {
            at[g] = x + 4 * g - (g == kGroups - 1 ? back : 0);
#pragma GCC unroll 4
            for (int o = 0; o < kQuads; ++o) sums[g][o] = (__m512)four_times(r.bias + 4 * o);
        }
        weight = static_cast<const std::uint32_t*>(r.weight);
    }
    template <int kUnit>
    EVENTIDE_QUADS_INLINE void add_unit(const __m512i (&in)[kGroups]) {
        __m512i w[kQuads];
#pragma GCC unroll 4
        for (int o = 0; o < kQuads; ++o) w[o] = four_times(weight + (kUnit * kQuads + o) * 4);
#pragma GCC unroll 8
        for (int g = 0; g < kGroups; ++g) {
            const __m512i spread = _mm512_shuffle_epi32(in[g], _MM_PERM_ENUM(kUnit * 0x55));
#pragma GCC unroll 4
            for (int o = 0; o < kQuads; ++o) sums[g][o] = Number::add(sums[g][o], spread, w[o]);
        }
    }
    template <class Layout>
    EVENTIDE_QUADS_INLINE void add(const Stretch& stretch, int y) {
        const auto* from = static_cast<const std::uint32_t*>(stretch.in) + y * stretch.pitch;
        const std::ptrdiff_t step = stretch.step;
        for (int k = 0; k < stretch.length; k += 4, weight += 16 * kQuads) {
            __m512i in[kGroups];
#pragma GCC unroll 8
            for (int g = 0; g < kGroups; ++g) in[g] = Layout::load(from + at[g] * step, step, k);
            add_unit<0>(in);
            add_unit<1>(in);
            add_unit<2>(in);
            add_unit<3>(in);
        }
    }
};

/// Four registers of a quad of outputs (q) each, to one for each pixel.
///
///     v[0]  p0 q0 | p1 q0 | p2 q0 | p3 q0        a  p0 q0 | p1 q0 | p0 q1 | p1 q1
///     v[1]  p0 q1 | p1 q1 | p2 q1 | p3 q1        b  p2 q0 | p3 q0 | p2 q1 | p3 q1
///     v[2]  p0 q2 | ...                          c, d: the same of q2 and q3
///     v[3]  p0 q3 | ...                     ->   v[0]  p0 q0 | p0 q1 | p0 q2 | p0 q3, ...
EVENTIDE_QUADS_INLINE void by_pixels(__m512 (&v)[4]) {
    const __m512 a = _mm512_shuffle_f32x4(v[0], v[1], 0x44),
                 b = _mm512_shuffle_f32x4(v[0], v[1], 0xee),
                 c = _mm512_shuffle_f32x4(v[2], v[3], 0x44),
                 d = _mm512_shuffle_f32x4(v[2], v[3], 0xee);
    v[0] = _mm512_shuffle_f32x4(a, c, 0x88);
    v[1] = _mm512_shuffle_f32x4(a, c, 0xdd);
    v[2] = _mm512_shuffle_f32x4(b, d, 0x88);
    v[3] = _mm512_shuffle_f32x4(b, d, 0xdd);
}
EVENTIDE_QUADS_INLINE void store(const DotArea& r, std::ptrdiff_t at, __m512 (&v)[4]) {
    by_pixels(v);
    if (r.to_bf16) {
        auto* out = static_cast<std::uint16_t*>(r.out) + 2 * at;
        _mm512_storeu_si512(out, (__m512i)_mm512_cvtne2ps_pbh(v[1], v[0]));
        _mm512_storeu_si512(out + 32, (__m512i)_mm512_cvtne2ps_pbh(v[3], v[2]));
        return;
    }
    float* out = static_cast<float*>(r.out) + at;
    for (int p = 0; p < 4; ++p) _mm512_storeu_ps(out + 16 * p, v[p]);
}
EVENTIDE_QUADS_INLINE void store(const DotArea& r, std::ptrdiff_t at, __m512 (&v)[2]) {
    // 8 outputs: p0 q0 | p0 q1 | p1 q0 | p1 q1, then the same of p2 and p3.
    const __m512i low = _mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11),
                  high = _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15);
    const auto a = (__m512)_mm512_permutex2var_epi64((__m512i)v[0], low, (__m512i)v[1]),
               b = (__m512)_mm512_permutex2var_epi64((__m512i)v[0], high, (__m512i)v[1]);
    if (r.to_bf16) {
        _mm512_storeu_si512(static_cast<std::uint16_t*>(r.out) + 2 * at,
                            (__m512i)_mm512_cvtne2ps_pbh(b, a));
        return;
    }
    float* out = static_cast<float*>(r.out) + at;
    _mm512_storeu_ps(out, a);
    _mm512_storeu_ps(out + 16, b);
}

template <class Number, int kGroups, int kQuads>
EVENTIDE_QUADS void dot_block(const DotArea& r, int y, int x, int back) {
    Block<Number, kGroups, kQuads> block;
    block.start(r, x, back);
    for (int s = 0; s < r.count; ++s) {
        const Stretch& stretch = r.stretches[s];
        if (stretch.step == 4)
            block.template add<Beside>(stretch, y);
        else if (stretch.step == 8)
            block.template add<InTwos>(stretch, y);
        else
            block.template add<Apart>(stretch, y);
    }
    const __m512 floor = _mm512_set1_ps(r.relu ? 0.0F : -std::numeric_limits<float>::infinity());
#pragma GCC unroll 8
    for (int g = 0; g < kGroups; ++g) {
#pragma GCC unroll 4
        for (int o = 0; o < kQuads; ++o) block.sums[g][o] = _mm512_max_ps(block.sums[g][o], floor);
        store(r, y * r.out_pitch + block.at[g] * r.out_step, block.sums[g]);
    }
}

/// What registers hold: sums, a quad of each group, weights and the unit that is spread.
constexpr int kMaxOfTwo = 8, kMaxOfFour = 5;
using Dot = void (*)(const DotArea&, int, int, int);
template <class Number, int kQuads, int... kGroups>
constexpr std::array<Dot, sizeof...(kGroups)> dots(std::integer_sequence<int, kGroups...>) {
    return {&dot_block<Number, kGroups + 1, kQuads>...};
}

/// The last group of a row overlaps the one before, where pixels do not come in fours.
template <class Number, int kQuads, int kMax>
void dot_rows(const DotArea& r) {
    static constexpr auto kDots = dots<Number, kQuads>(std::make_integer_sequence<int, kMax>{});
    // Of 10 pixels: groups from 0, 4 and 6 (back 2); pixels 6 and 7 are written twice, the same.
    const int groups = (r.width + 3) / 4, parts = (groups + kMax - 1) / kMax;
    for (int y = 0; y < r.height; ++y)
        for (int part = 0; part < parts; ++part) {
            const int first = groups * part / parts, end = groups * (part + 1) / parts;
            const int back = part + 1 == parts ? 4 * groups - r.width : 0;
            kDots[std::size_t(end - first - 1)](r, y, 4 * first, back);
        }
}

template <class Number>
void dot_quads(const DotArea& r) {
    r.outputs == 8 ? dot_rows<Number, 2, kMaxOfTwo>(r) : dot_rows<Number, 4, kMaxOfFour>(r);
}

}  // namespace

EVENTIDE_QUADS void split_pixels(const SplitRow& r) {
    for (int map = 0; map < r.maps; ++map) {
        const int first = map * r.size, n = std::clamp(r.channels - first, 0, r.size);
        const auto there = __mmask8((1U << unsigned(n)) - 1U),
                   stored = __mmask8((1U << unsigned(r.size)) - 1U);
        const float* in = r.in + first;
        float* out = static_cast<float*>(r.out) + map * r.plane;
        for (int p = 0; p < r.pixels; ++p, in += r.channels, out += r.size)
            _mm256_mask_storeu_ps(out, stored, _mm256_maskz_loadu_ps(there, in));
    }
}
void dot_quads_f32(const DotArea& r) {
    dot_quads<F32>(r);
}
void dot_quads_bf16(const DotArea& r) {
    dot_quads<Bf16>(r);
}
#else
void dot_quads_f32(const DotArea&) {}
void dot_quads_bf16(const DotArea&) {}
void split_pixels(const SplitRow&) {}
#endif

}  // namespace eventide::avx512
