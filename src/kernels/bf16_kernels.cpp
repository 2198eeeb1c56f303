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

namespace {

template <typename NarrowRow>
void narrow_pixels(NarrowRow row_to_bf16, const float* in, std::size_t pixels, int channels,
                   std::uint32_t* out) {
    auto* numbers = reinterpret_cast<std::uint16_t*>(out);
    const auto count = std::size_t(channels);
    if (channels % 2 == 0) {
        row_to_bf16(in, pixels * count, numbers);
        return;
    }
    for (std::size_t p = 0; p < pixels; ++p) {
        row_to_bf16(in + p * count, count, numbers + p * (count + 1));
        numbers[p * (count + 1) + count] = 0;
    }
}

}  // namespace

#if defined(__x86_64__)
namespace {

EVENTIDE_BF16_INLINE __mmask16 first_lanes(int n) {
    return __mmask16(n >= 16 ? 0xffffu : (1u << unsigned(std::max(n, 0))) - 1u);
}

/// 16 sums in a register, or 8.
struct Wide {
    static constexpr int kLanes = 16;
    using Sum = __m512;
    using Pairs = __m512i;
    EVENTIDE_BF16_INLINE static Sum all(float v) { return _mm512_set1_ps(v); }
    EVENTIDE_BF16_INLINE static Sum load(const float* from) { return _mm512_loadu_ps(from); }
    EVENTIDE_BF16_INLINE static Pairs load(const std::uint32_t* from) {
        return _mm512_loadu_si512(from);
    }
    EVENTIDE_BF16_INLINE static Pairs all(std::uint32_t pair) {
        return _mm512_set1_epi32(int(pair));
    }
    EVENTIDE_BF16_INLINE static Sum add(Sum sum, Pairs a, Pairs b) {
        return _mm512_dpbf16_ps(sum, (__m512bh)a, (__m512bh)b);
    }
    EVENTIDE_BF16_INLINE static void store(float* to, int n, Sum v, Sum floor) {
        _mm512_mask_storeu_ps(to, first_lanes(n), _mm512_max_ps(v, floor));
    }
};
struct Narrow {
    static constexpr int kLanes = 8;
    using Sum = __m256;
    using Pairs = __m256i;
    EVENTIDE_BF16_INLINE static Sum all(float v) { return _mm256_set1_ps(v); }
    EVENTIDE_BF16_INLINE static Sum load(const float* from) { return _mm256_loadu_ps(from); }
    EVENTIDE_BF16_INLINE static Pairs load(const std::uint32_t* from) {
        return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
    }
    EVENTIDE_BF16_INLINE static Pairs all(std::uint32_t pair) {
        return _mm256_set1_epi32(int(pair));
    }
    EVENTIDE_BF16_INLINE static Sum add(Sum sum, Pairs a, Pairs b) {
        return _mm256_dpbf16_ps(sum, (__m256bh)a, (__m256bh)b);
    }
    EVENTIDE_BF16_INLINE static void store(float* to, int n, Sum v, Sum floor) {
        _mm256_mask_storeu_ps(to, __mmask8(first_lanes(std::min(n, 8))), _mm256_max_ps(v, floor));
    }
};

/// Register block; see Sums in vector_dots-inl.h.
template <class Vector, int P, bool kTwo>
struct Sums {
    using Sum = typename Vector::Sum;
    using Pairs = typename Vector::Pairs;
    Sums<Vector, P - 1, kTwo> before;
    Sum a, b;

    EVENTIDE_BF16_INLINE void start(Sum bias_a, Sum bias_b) {
        before.start(bias_a, bias_b);
        a = bias_a;
        if (kTwo) b = bias_b;
    }
    EVENTIDE_BF16_INLINE void add(const std::uint32_t* in, std::ptrdiff_t step, Pairs weight_a,
                                  Pairs weight_b) {
        before.add(in, step, weight_a, weight_b);
        const Pairs pair = Vector::all(in[(P - 1) * step]);
        a = Vector::add(a, pair, weight_a);
        if (kTwo) b = Vector::add(b, pair, weight_b);
    }
    EVENTIDE_BF16_INLINE void store(float* out, std::ptrdiff_t step, int outputs, Sum floor) const {
        before.store(out, step, outputs, floor);
        float* to = out + (P - 1) * step;
        Vector::store(to, outputs, a, floor);
        if (kTwo) Vector::store(to + Vector::kLanes, outputs - Vector::kLanes, b, floor);
    }
};
template <class Vector, bool kTwo>
struct Sums<Vector, 0, kTwo> {
    using Sum = typename Vector::Sum;
    using Pairs = typename Vector::Pairs;
    EVENTIDE_BF16_INLINE void start(Sum, Sum) {}
    EVENTIDE_BF16_INLINE void add(const std::uint32_t*, std::ptrdiff_t, Pairs, Pairs) {}
    EVENTIDE_BF16_INLINE void store(float*, std::ptrdiff_t, int, Sum) const {}
};

template <class Vector, int P, bool kTwo>
EVENTIDE_BF16 void dot_block(const Bf16DotRows& r, const std::uint32_t* in,
                             const std::uint32_t* weight, int first, float* out) {
    constexpr int kWidth = kTwo ? 2 * Vector::kLanes : Vector::kLanes;
    const float* bias = r.bias + first;
    Sums<Vector, P, kTwo> sums;
    sums.start(Vector::load(bias), Vector::load(bias + kWidth - Vector::kLanes));
    for (int s = 0; s < r.stretches; ++s) {
        const std::uint32_t* from = in + s * r.pitch;
        for (int k = 0; k < r.length; ++k) {
            sums.add(from + k, r.step, Vector::load(weight),
                     Vector::load(weight + kWidth - Vector::kLanes));
            weight += kWidth;
        }
    }
    const auto floor = Vector::all(r.relu ? 0.0F : -std::numeric_limits<float>::infinity());
    sums.store(out, r.out_step, r.outputs - first, floor);
}

constexpr int kMaxPixels = 18, kMaxPixelsOfTwo = 14;
using Block = void (*)(const Bf16DotRows&, const std::uint32_t*, const std::uint32_t*, int, float*);
template <class Vector, bool kTwo, int... P>
constexpr std::array<Block, sizeof...(P)> blocks(std::integer_sequence<int, P...>) {
    return {&dot_block<Vector, P + 1, kTwo>...};
}

template <class Vector>
void dot_rows_by(const Bf16DotRows& r) {
    static constexpr auto kOne =
        blocks<Vector, false>(std::make_integer_sequence<int, kMaxPixels>{});
    static constexpr auto kTwo =
        blocks<Vector, true>(std::make_integer_sequence<int, kMaxPixelsOfTwo>{});
    dot_in_blocks(r, Vector::kLanes, kOne, kTwo);
}

void dot_rows(const Bf16DotRows& r) {
    bf16_lanes(r.outputs) == Narrow::kLanes ? dot_rows_by<Narrow>(r) : dot_rows_by<Wide>(r);
}

EVENTIDE_BF16 void row_to_bf16(const float* in, std::size_t n, std::uint16_t* out) {
    for (std::size_t i = 0; i < n; i += 16) {
        const __mmask16 mask = first_lanes(int(std::min<std::size_t>(n - i, 16)));
        const __m256bh pixels_to_bf16 = _mm512_cvtneps_pbh(_mm512_maskz_loadu_ps(mask, in + i));
        _mm256_mask_storeu_epi16(out + i, mask, (__m256i)pixels_to_bf16);
    }
}

void pixels_to_bf16(const float* in, std::size_t pixels, int channels, std::uint32_t* out) {
    narrow_pixels(row_to_bf16, in, pixels, channels, out);
}

}  // namespace
#endif

const Bf16Kernels* bf16_kernels() {
#if defined(__x86_64__)
    static const Bf16Kernels kKernels{dot_rows, pixels_to_bf16, row_to_bf16};
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
    const int lanes = bf16_lanes(r.outputs);
    for (int first = 0; first < r.outputs;) {
        const int width = r.outputs - first > lanes ? 2 * lanes : lanes;
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

void row_to_bf16(const float* in, std::size_t n, std::uint16_t* out) {
    std::transform(in, in + n, out, to_bf16);
}
void pixels_to_bf16(const float* in, std::size_t pixels, int channels, std::uint32_t* out) {
    narrow_pixels(row_to_bf16, in, pixels, channels, out);
}

}  // namespace

const Bf16Kernels& bf16_kernels() {
    static const Bf16Kernels kKernels{dot_rows, pixels_to_bf16, row_to_bf16};
    return kKernels;
}

}  // namespace plain
}  // namespace eventide
