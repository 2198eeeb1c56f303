// See bf16_kernels.h. Highway has no bf16 product for these processors yet, hence intrinsics; they
// are compiled for their instruction set function by function and called only where it is there.
#include "src/kernels/bf16_kernels.h"

#include "src/kernels/dot_blocks.h"
#include "src/kernels/vector_kernels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <utility>

#if defined(__x86_64__)
#include <immintrin.h>
#define EVENTIDE_BF16 __attribute__((target("avx512f,avx512bw,avx512vl,avx512dq,avx512bf16")))
#define EVENTIDE_BF16_INLINE EVENTIDE_BF16 __attribute__((always_inline)) inline
#endif

namespace eventide {

std::uint16_t to_bf16(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    return std::uint16_t((bits + 0x7fffu + ((bits >> 16) & 1u)) >> 16);
}

namespace {

template <typename NarrowRow>
void narrow_pixels(NarrowRow narrow_row, const float* in, std::size_t pixels, int channels,
                   std::uint32_t* out) {
    auto* numbers = reinterpret_cast<std::uint16_t*>(out);
    const auto count = std::size_t(channels);
    if (channels % 2 == 0) {
        narrow_row(in, pixels * count, numbers);
        return;
    }
    for (std::size_t p = 0; p < pixels; ++p) {
        narrow_row(in + p * count, count, numbers + p * (count + 1));
        numbers[p * (count + 1) + count] = 0;
    }
}

}  // namespace

#if defined(__x86_64__)
namespace {

/// Register block; see Sums in vector_dots-inl.h.
template <int P, bool kTwo>
struct Sums {
    Sums<P - 1, kTwo> before;
    __m512 a, b;

    EVENTIDE_BF16_INLINE void start(__m512 bias_a, __m512 bias_b) {
        before.start(bias_a, bias_b);
        a = bias_a;
        if (kTwo) b = bias_b;
    }
    EVENTIDE_BF16_INLINE void add(const std::uint32_t* in, std::ptrdiff_t step, __m512i weight_a,
                                  __m512i weight_b) {
        before.add(in, step, weight_a, weight_b);
        const auto pair = (__m512bh)_mm512_set1_epi32(int(in[(P - 1) * step]));
        a = _mm512_dpbf16_ps(a, pair, (__m512bh)weight_a);
        if (kTwo) b = _mm512_dpbf16_ps(b, pair, (__m512bh)weight_b);
    }
    EVENTIDE_BF16_INLINE void store(float* out, std::ptrdiff_t step, __mmask16 mask_a,
                                    __mmask16 mask_b, __m512 floor) const {
        before.store(out, step, mask_a, mask_b, floor);
        float* to = out + (P - 1) * step;
        _mm512_mask_storeu_ps(to, mask_a, _mm512_max_ps(a, floor));
        if (kTwo) _mm512_mask_storeu_ps(to + 16, mask_b, _mm512_max_ps(b, floor));
    }
};
template <bool kTwo>
struct Sums<0, kTwo> {
    EVENTIDE_BF16_INLINE void start(__m512, __m512) {}
    EVENTIDE_BF16_INLINE void add(const std::uint32_t*, std::ptrdiff_t, __m512i, __m512i) {}
    EVENTIDE_BF16_INLINE void store(float*, std::ptrdiff_t, __mmask16, __mmask16, __m512) const {}
};

EVENTIDE_BF16_INLINE __mmask16 first_lanes(int n) {
    return __mmask16(n >= 16 ? 0xffffu : (1u << unsigned(std::max(n, 0))) - 1u);
}

template <int P, bool kTwo>
EVENTIDE_BF16 void dot_block(const Bf16DotRows& r, const std::uint32_t* in,
                             const std::uint32_t* weight, int first, float* out) {
    constexpr int kWidth = kTwo ? 32 : 16;
    const float* bias = r.bias + first;
    Sums<P, kTwo> sums;
    sums.start(_mm512_loadu_ps(bias), _mm512_loadu_ps(bias + kWidth - 16));
    for (int s = 0; s < r.stretches; ++s) {
        const std::uint32_t* from = in + s * r.pitch;
        for (int k = 0; k < r.length; ++k) {
            sums.add(from + k, r.step, _mm512_loadu_si512(weight),
                     _mm512_loadu_si512(weight + kWidth - 16));
            weight += kWidth;
        }
    }
    const __m512 floor = _mm512_set1_ps(r.relu ? 0.0F : -std::numeric_limits<float>::infinity());
    sums.store(out, r.out_step, first_lanes(r.outputs - first), first_lanes(r.outputs - first - 16),
               floor);
}

constexpr int kMaxPixels = 14;
using Block = void (*)(const Bf16DotRows&, const std::uint32_t*, const std::uint32_t*, int, float*);
template <bool kTwo, int... P>
constexpr std::array<Block, sizeof...(P)> blocks(std::integer_sequence<int, P...>) {
    return {&dot_block<P + 1, kTwo>...};
}

void dot_rows(const Bf16DotRows& r) {
    static constexpr auto kOne = blocks<false>(std::make_integer_sequence<int, kMaxPixels>{});
    static constexpr auto kTwo = blocks<true>(std::make_integer_sequence<int, kMaxPixels>{});
    dot_in_blocks(r, kBf16Lanes, kOne, kTwo);
}

EVENTIDE_BF16 void narrow_row(const float* in, std::size_t n, std::uint16_t* out) {
    for (std::size_t i = 0; i < n; i += 16) {
        const __mmask16 mask = first_lanes(int(std::min<std::size_t>(n - i, 16)));
        const __m256bh narrow = _mm512_cvtneps_pbh(_mm512_maskz_loadu_ps(mask, in + i));
        _mm256_mask_storeu_epi16(out + i, mask, (__m256i)narrow);
    }
}

void narrow(const float* in, std::size_t pixels, int channels, std::uint32_t* out) {
    narrow_pixels(narrow_row, in, pixels, channels, out);
}

}  // namespace
#endif

const Bf16Kernels* bf16_kernels() {
#if defined(__x86_64__)
    static const Bf16Kernels kKernels{dot_rows, narrow, narrow_row};
    // Compilers' names for processor features are younger than the instruction; avx512bf16 is known
    // to gcc 12 and clang 14.
    static const bool kThere =
        __builtin_cpu_supports("avx512bf16") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
        __builtin_cpu_supports("avx512vl") != 0 && __builtin_cpu_supports("avx512dq") != 0;
    if (kThere && !kernels_limited()) return &kKernels;
#endif
    return nullptr;
}

namespace plain {
namespace {

/// The two numbers of a pair, low half first.
float first_of(std::uint32_t pair) {
    return std::bit_cast<float>(pair << 16);
}
float second_of(std::uint32_t pair) {
    return std::bit_cast<float>(pair & 0xffff'0000U);
}

/// A product of two bf16 numbers is exact in float32, so only the sums round, as in the processor.
void dot_rows(const Bf16DotRows& r) {
    const std::uint32_t* weight = r.weight;
    for (int first = 0; first < r.outputs;) {
        const int width = r.outputs - first > kBf16Lanes ? 2 * kBf16Lanes : kBf16Lanes;
        const std::ptrdiff_t packed = std::ptrdiff_t(r.stretches) * r.length * width;
        for (int p = 0; p < r.pixels; ++p) {
            std::array<float, 2 * kBf16Lanes> sums{};
            std::copy_n(r.bias + first, width, sums.begin());
            const std::uint32_t* w = weight;
            for (int s = 0; s < r.stretches; ++s)
                for (int k = 0; k < r.length; ++k, w += width) {
                    const std::uint32_t pair = r.in[s * r.pitch + p * r.step + k];
                    const float a = first_of(pair), b = second_of(pair);
                    for (std::size_t o = 0; o < std::size_t(width); ++o)
                        sums[o] = (sums[o] + b * second_of(w[o])) + a * first_of(w[o]);
                }
            for (int o = 0; o < std::min(width, r.outputs - first); ++o) {
                const float sum = sums[std::size_t(o)];
                r.out[p * r.out_step + first + o] = r.relu ? std::max(sum, 0.0F) : sum;
            }
        }
        weight += packed;
        first += width;
    }
}

void narrow_row(const float* in, std::size_t n, std::uint16_t* out) {
    std::transform(in, in + n, out, to_bf16);
}
void narrow(const float* in, std::size_t pixels, int channels, std::uint32_t* out) {
    narrow_pixels(narrow_row, in, pixels, channels, out);
}

}  // namespace

const Bf16Kernels& bf16_kernels() {
    static const Bf16Kernels kKernels{dot_rows, narrow, narrow_row};
    return kKernels;
}

}  // namespace plain
}  // namespace eventide
