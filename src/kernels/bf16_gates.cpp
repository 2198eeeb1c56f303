// See bf16_gates.h, by AVX-512.
#include "src/kernels/bf16_gates.h"

#if defined(__x86_64__)

#include "src/kernels/bf16_vectors.h"

#include <algorithm>

namespace eventide::avx512_bf16 {
namespace {

constexpr int kLanes = 16, kHalf = 8;

/// c_0 + c_1 x + ... + c_{n-1} x^{n-1}
template <std::size_t n>
EVENTIDE_BF16_INLINE __m512 polynomial(const float (&c)[n], __m512 x) {
    __m512 sum = _mm512_set1_ps(c[n - 1]);
    for (std::size_t k = n - 1; k-- > 0;) sum = _mm512_fmadd_ps(sum, x, _mm512_set1_ps(c[k]));
    return sum;
}

/// 1 / (1 + exp(-scale v)), to within 3e-7. exp(w) = 2^n 2^f, f within +-.5, 2^f by a polynomial
/// that is nearest in the largest error.
EVENTIDE_BF16_INLINE __m512 sigmoid(__m512 v, float scale) {
    static constexpr float kPower[] = {1.0F,          0.693147242F,   0.240222350F,
                                       0.0555030853F, 0.00967186131F, 0.00134072371F};
    constexpr float kLog2E = 1.44269504F;
    constexpr float kMost = 60.0F;  // beyond, nothing but slow denormal numbers would change
    const __m512 one = _mm512_set1_ps(1.0F), most = _mm512_set1_ps(kMost),
                 least = _mm512_set1_ps(-kMost);
    const __m512 w = _mm512_max_ps(
        _mm512_min_ps(_mm512_mul_ps(v, _mm512_set1_ps(-scale * kLog2E)), most), least);
    const __m512 whole = _mm512_roundscale_ps(w, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
    const __m512 power = _mm512_scalef_ps(polynomial(kPower, _mm512_sub_ps(w, whole)), whole);
    const __m512 sum = _mm512_add_ps(one, power);
    // A step of Newton's from 14 bits.
    const __m512 near = _mm512_rcp14_ps(sum);
    return _mm512_mul_ps(near, _mm512_fnmadd_ps(sum, near, _mm512_set1_ps(2.0F)));
}

/// log(1 + x), x >= 0. 1 + x = 2^e m, m from 1 to 2.
EVENTIDE_BF16_INLINE __m512 log1p(__m512 x) {
    static constexpr float kLog[] = {0.999992907F,  -0.499426275F, 0.325724274F,
                                     -0.211494803F, 0.102872327F,  -0.0245283619F};
    constexpr float kLn2 = 0.693147181F;
    const __m512 one = _mm512_set1_ps(1.0F), y = _mm512_add_ps(x, one),
                 f = _mm512_sub_ps(_mm512_getmant_ps(y, _MM_MANT_NORM_1_2, _MM_MANT_SIGN_zero),
                                   one);
    return _mm512_fmadd_ps(_mm512_getexp_ps(y), _mm512_set1_ps(kLn2),
                           _mm512_mul_ps(f, polynomial(kLog, f)));
}
EVENTIDE_BF16_INLINE __m512 compressed(__m512 v) {
    if (_mm512_test_epi32_mask((__m512i)v, (__m512i)v) == 0) return v;  // most of a grid
    const __m512 sign = _mm512_set1_ps(-0.0F);
    return _mm512_or_ps(log1p(_mm512_andnot_ps(sign, v)), _mm512_and_ps(sign, v));
}

/// Up to 16 numbers of one pixel, or 8 of each of two beside each other.
EVENTIDE_BF16_INLINE __m512 load(const float* from, __mmask16 mask) {
    return _mm512_maskz_loadu_ps(mask, from);
}
EVENTIDE_BF16_INLINE __m512 load_two(const float* from, std::ptrdiff_t step) {
    return _mm512_insertf32x8(_mm512_castps256_ps512(_mm256_loadu_ps(from)),
                              _mm256_loadu_ps(from + step), 1);
}
EVENTIDE_BF16_INLINE void store(std::uint16_t* to, __mmask16 mask, __m512 v) {
    _mm256_mask_storeu_epi16(to, mask, (__m256i)_mm512_cvtneps_pbh(v));
}

EVENTIDE_BF16_INLINE __m512 updated(__m512 h, __m512 u, __m512 v, float scale) {
    const __m512 c = _mm512_fmsub_ps(_mm512_set1_ps(2.0F), sigmoid(v, scale), _mm512_set1_ps(1.0F));
    return _mm512_fmadd_ps(sigmoid(u, 1.0F), _mm512_sub_ps(c, h), h);
}

/// body(pixel, first channel, lanes that are there, lanes stored as bf16), 16 channels at a time.
template <typename Body>
EVENTIDE_BF16_INLINE void over_pixels(int first, int pixels, int channels, const Body& body) {
    const int even = (channels + 1) / 2 * 2;
    for (int p = first; p < pixels; ++p)
        for (int c = 0; c < channels; c += kLanes)
            body(p, c, first_lanes(channels - c), first_lanes(even - c));
}

}  // namespace

EVENTIDE_BF16 void keep_row(const KeepRow& r) {
    int done = 0;
    // Pixels of 8 channels go in twos, with the same bits.
    if (r.channels == kHalf)
        for (; done + 2 <= r.pixels; done += 2) {
            const std::ptrdiff_t at = std::ptrdiff_t{done} * kHalf;
            store(r.kept + at, 0xffff,
                  _mm512_mul_ps(sigmoid(load_two(r.r + done * r.r_step, r.r_step), 1.0F),
                                widened(r.h + at, 0xffff)));
        }
    const std::ptrdiff_t step = (r.channels + 1) / 2 * 2;
    over_pixels(done, r.pixels, r.channels,
                [&](int p, int c, __mmask16 there, __mmask16 stored) EVENTIDE_BF16 {
                    store(r.kept + p * step + c, stored,
                          _mm512_mul_ps(sigmoid(load(r.r + p * r.r_step + c, there), 1.0F),
                                        widened(r.h + p * step + c, there)));
                });
}

EVENTIDE_BF16 void update_row(const UpdateRow& r) {
    const float scale = r.is_doubled ? 1.0F : 2.0F;
    int done = 0;
    if (r.channels == kHalf)
        for (; done + 2 <= r.pixels; done += 2) {
            float* h = r.h + std::ptrdiff_t{done} * kHalf;
            __builtin_prefetch(h + r.ahead, 1);
            const __m512 next =
                updated(_mm512_loadu_ps(h), load_two(r.u + done * r.u_step, r.u_step),
                        load_two(r.v + done * r.v_step, r.v_step), scale);
            _mm512_storeu_ps(h, next);
            store(r.rounded + std::ptrdiff_t{done} * kHalf, 0xffff, next);
        }
    const std::ptrdiff_t step = (r.channels + 1) / 2 * 2;
    over_pixels(done, r.pixels, r.channels,
                [&](int p, int c, __mmask16 there, __mmask16 stored) EVENTIDE_BF16 {
                    float* h = r.h + std::ptrdiff_t{p} * r.channels + c;
                    const __m512 next = _mm512_maskz_mov_ps(
                        there, updated(load(h, there), load(r.u + p * r.u_step + c, there),
                                       load(r.v + p * r.v_step + c, there), scale));
                    _mm512_mask_storeu_ps(h, there, next);
                    store(r.rounded + p * step + c, stored, next);
                });
}

/// Numbers one after the other, as a pixel's channels do not fill vectors. A line is fetched while
/// one is worked on: all at once they would wait for each other.
EVENTIDE_BF16_INLINE void compress(const float* in, int n, std::ptrdiff_t ahead, float* out) {
    for (int i = 0; i < n; i += kLanes) {
        __builtin_prefetch(in + i + ahead);
        _mm512_storeu_ps(out + i, compressed(load(in + i, first_lanes(n - i))));
    }
}
/// Pixels of up to 32 numbers to bf16, in one map or in several.
EVENTIDE_BF16_INLINE void narrow_pixels(const CompressRow& r, const float* in, int pixels, int c,
                                        std::uint32_t* out) {
    const std::ptrdiff_t step = r.size / 2;  // units
    const __mmask16 low = first_lanes(r.channels - c), high = first_lanes(r.channels - c - kLanes),
                    stored = first_lanes(int(step) - c / 2);
    for (int p = 0; p < pixels; ++p, in += r.channels, out += step) {
        const auto both = (__m512i)_mm512_cvtne2ps_pbh(load(in + kLanes, high), load(in, low));
        if (r.maps == 1) {
            _mm512_mask_storeu_epi32(out, stored, both);
            continue;
        }
        const auto put = [&](int map, __m128i quad) EVENTIDE_BF16 {
            if (map < r.maps)
                _mm_storeu_si128(reinterpret_cast<__m128i*>(out + map * r.plane), quad);
        };
        put(0, _mm512_castsi512_si128(both));
        put(1, _mm512_extracti32x4_epi32(both, 1));
        put(2, _mm512_extracti32x4_epi32(both, 2));
        put(3, _mm512_extracti32x4_epi32(both, 3));
    }
}

/// A few pixels at a time, which stay in the first-level cache.
EVENTIDE_BF16 void compress_row(const CompressRow& r) {
    constexpr int kRoom = 1024;
    alignas(64) float room[kRoom + kLanes];
    const int most = kRoom / r.channels;
    auto* out = static_cast<std::uint32_t*>(r.out);
    for (int p = 0; p < r.pixels; p += most) {
        const int pixels = std::min(most, r.pixels - p);
        compress(r.in + std::ptrdiff_t{p} * r.channels, pixels * r.channels, r.ahead, room);
        // Several maps are one round: at most 4 of 8.
        for (int c = 0; c < r.size; c += 2 * kLanes)
            narrow_pixels(r, room + c, pixels, c, out + std::ptrdiff_t{p} * r.size / 2 + c / 2);
    }
}

}  // namespace eventide::avx512_bf16

#else

namespace eventide::avx512_bf16 {

void keep_row(const KeepRow&) {}
void update_row(const UpdateRow&) {}
void compress_row(const CompressRow&) {}

}  // namespace eventide::avx512_bf16

#endif
