// See bf16_kernels.h, by AVX512_BF16. Highway has no bf16 product for these processors yet, hence
// intrinsics; they are compiled for their instruction set function by function and called only
// where it is there.
#include "src/kernels/bf16_kernels.h"

#include "src/kernels/bf16_render.h"
#include "src/kernels/bf16_winograd.h"
#include "src/kernels/dot_blocks.h"
#include "src/kernels/pixels_to_bf16.h"
#include "src/kernels/quad_dots.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <utility>

#if defined(__x86_64__)
#include "src/kernels/bf16_vectors.h"
#endif

namespace eventide {

#if defined(__x86_64__)
namespace {

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
    EVENTIDE_BF16_INLINE static void store(std::uint16_t* to, int n, Sum v, Sum floor) {
        _mm256_mask_storeu_epi16(to, first_lanes(n),
                                 (__m256i)_mm512_cvtneps_pbh(_mm512_max_ps(v, floor)));
    }
};
/// For layers of at most 8 outputs (bf16_lanes()), which half a register holds.
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
        _mm256_mask_storeu_ps(to, __mmask8(first_lanes(n)), _mm256_max_ps(v, floor));
    }
    EVENTIDE_BF16_INLINE static void store(std::uint16_t* to, int n, Sum v, Sum floor) {
        _mm_mask_storeu_epi16(to, __mmask8(first_lanes(n)),
                              (__m128i)_mm256_cvtneps_pbh(_mm256_max_ps(v, floor)));
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
    template <typename Number>
    EVENTIDE_BF16_INLINE void store(Number* out, std::ptrdiff_t step, int outputs,
                                    Sum floor) const {
        before.store(out, step, outputs, floor);
        Number* to = out + (P - 1) * step;
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
    template <typename Number>
    EVENTIDE_BF16_INLINE void store(Number*, std::ptrdiff_t, int, Sum) const {}
};

/// One unit: a pair of each of P pixels times that pair's weights for all outputs of the block.
template <class Vector, int P, bool kTwo>
EVENTIDE_BF16_INLINE void add_pair(Sums<Vector, P, kTwo>& sums, const std::uint32_t* from,
                                   std::ptrdiff_t step, const std::uint32_t* weight) {
    constexpr int kSecond = kTwo ? Vector::kLanes : 0;
    sums.add(from, step, Vector::load(weight), Vector::load(weight + kSecond));
}

template <class Vector, int P, bool kTwo>
EVENTIDE_BF16 void dot_block(const DotArea& r, const std::uint32_t* weight, int y, int x,
                             int first) {
    constexpr int kWidth = kTwo ? 2 * Vector::kLanes : Vector::kLanes;
    const float* bias = r.bias + first;
    Sums<Vector, P, kTwo> sums;
    sums.start(Vector::load(bias), Vector::load(bias + kWidth - Vector::kLanes));
    for (int s = 0; s < r.count; ++s) {
        const Stretch& stretch = r.stretches[s];
        const std::ptrdiff_t step = stretch.step;
        const auto* from =
            static_cast<const std::uint32_t*>(stretch.in) + y * stretch.pitch + x * step;
        // Four at a time: stretches are short, and the end of each loop costs a wrong guess.
        int k = 0;
        for (; k + 4 <= stretch.length; k += 4, weight += 4 * kWidth) {
            add_pair<Vector, P, kTwo>(sums, from + k, step, weight);
            add_pair<Vector, P, kTwo>(sums, from + k + 1, step, weight + kWidth);
            add_pair<Vector, P, kTwo>(sums, from + k + 2, step, weight + 2 * kWidth);
            add_pair<Vector, P, kTwo>(sums, from + k + 3, step, weight + 3 * kWidth);
        }
        for (; k < stretch.length; ++k, weight += kWidth)
            add_pair<Vector, P, kTwo>(sums, from + k, step, weight);
    }
    const auto floor = Vector::all(r.relu ? 0.0F : -std::numeric_limits<float>::infinity());
    const std::ptrdiff_t to = y * r.out_pitch + x * r.out_step;
    // As bf16 an even number of outputs is stored. The one past an odd last has weights and bias of
    // zero (PackedWeights), so its sum is the zero that belongs there.
    if (r.to_bf16)
        sums.store(static_cast<std::uint16_t*>(r.out) + 2 * to + first, 2 * r.out_step,
                   (r.outputs + 1) / 2 * 2 - first, floor);
    else
        sums.store(static_cast<float*>(r.out) + to + first, r.out_step, r.outputs - first, floor);
}

constexpr int kMaxPixels = 18, kMaxPixelsOfTwo = 14;
using Block = void (*)(const DotArea&, const std::uint32_t*, int, int, int);
template <class Vector, bool kTwo, int... P>
constexpr std::array<Block, sizeof...(P)> blocks(std::integer_sequence<int, P...>) {
    return {&dot_block<Vector, P + 1, kTwo>...};
}

template <class Vector>
void dot_area_by(const DotArea& r) {
    static constexpr auto kOne =
        blocks<Vector, false>(std::make_integer_sequence<int, kMaxPixels>{});
    static constexpr auto kTwo =
        blocks<Vector, true>(std::make_integer_sequence<int, kMaxPixelsOfTwo>{});
    dot_in_blocks<std::uint32_t>(r, Vector::kLanes, kOne, kTwo);
}

void dot_area(const DotArea& r) {
    if (avx512::takes_quads(r)) {
        avx512::dot_quads_bf16(r);
        return;
    }
    bf16_lanes(r.outputs) == Narrow::kLanes ? dot_area_by<Narrow>(r) : dot_area_by<Wide>(r);
}

EVENTIDE_BF16 void row_to_bf16(const float* in, std::size_t n, std::uint16_t* out) {
    for (std::size_t i = 0; i < n; i += 16) {
        const __mmask16 mask = first_lanes(int(std::min<std::size_t>(n - i, 16)));
        const __m256bh pixels_to_bf16 = _mm512_cvtneps_pbh(_mm512_maskz_loadu_ps(mask, in + i));
        _mm256_mask_storeu_epi16(out + i, mask, (__m256i)pixels_to_bf16);
    }
}

/// Of an odd number of channels a pixel at a time, with the zero that `mask` loads.
EVENTIDE_BF16 void odd_pixels_to_bf16(const float* in, std::size_t pixels, int channels,
                                      std::uint32_t* out) {
    const __mmask16 low = first_lanes(channels), high = first_lanes(channels - 16),
                    stored = first_lanes((channels + 1) / 2);
    for (std::size_t p = 0; p < pixels; ++p, in += channels, out += (channels + 1) / 2)
        _mm512_mask_storeu_epi32(out, stored,
                                 (__m512i)_mm512_cvtne2ps_pbh(_mm512_maskz_loadu_ps(high, in + 16),
                                                              _mm512_maskz_loadu_ps(low, in)));
}

void pixels_to_bf16(const float* in, std::size_t pixels, int channels, std::uint32_t* out) {
    constexpr int kTwoVectors = 32;
    channels % 2 != 0 && channels < kTwoVectors
        ? odd_pixels_to_bf16(in, pixels, channels, out)
        : convert_pixels(row_to_bf16, in, pixels, channels, out);
}

/// Sample by sample, for the two pixels it is left of: the one on it, and the one before the next.
/// See double_channels() in vector_maps-inl.h; numbers are rounded once, when they are stored. A
/// quarter is taken of each column, which changes no bit of its sums.
EVENTIDE_BF16 void double_row(const DoubleRow& r) {
    const auto *above = static_cast<const std::uint16_t*>(r.above),
               *under = static_cast<const std::uint16_t*>(r.under);
    const auto n = std::ptrdiff_t(r.channels);
    auto* const out = static_cast<std::uint16_t*>(r.out) - r.x0 * n;
    for (std::ptrdiff_t c = 0; c < n; c += 16) {
        const __mmask16 mask = first_lanes(int(n - c));
        const auto column = [&](int sample) EVENTIDE_BF16 {
            return _mm512_mul_ps(_mm512_add_ps(widened(above + sample * n + c, mask),
                                               widened(under + sample * n + c, mask)),
                                 _mm512_set1_ps(0.25F));
        };
        const auto put = [&](int x, __m256i numbers) EVENTIDE_BF16 {
            if (x >= r.x0 && x < r.x1) _mm256_mask_storeu_epi16(out + x * n + c, mask, numbers);
        };
        __m512 left = column(r.x0 / 2);
        for (int sample = r.x0 / 2; 2 * sample < r.x1; ++sample) {
            const __m512 right = column(std::min(sample + 1, r.last));
            const auto both =
                (__m512i)_mm512_cvtne2ps_pbh(_mm512_add_ps(left, right), _mm512_add_ps(left, left));
            put(2 * sample, _mm512_castsi512_si256(both));
            put(2 * sample + 1, _mm512_extracti64x4_epi64(both, 1));
            left = right;
        }
    }
}

/// `step`: numbers of a pixel with the zero beside an odd last, which is stored, too (`stored`):
/// there `mask` has loaded zeros.
EVENTIDE_BF16 void offset_rows(const OffsetRows& r) {
    const std::ptrdiff_t width = r.width, step = (width + 1) / 2 * 2;
    constexpr std::ptrdiff_t kLine = 64 / sizeof(std::uint16_t);
    for (int p = 0; p < r.pixels; ++p) {
        const std::uint16_t* sums = static_cast<const std::uint16_t*>(r.sums) + r.column[p] * step;
        auto* out = static_cast<std::uint16_t*>(r.out) + p * step;
        if (r.ahead != 0)
            for (std::ptrdiff_t c = 0; c < step; c += kLine)
                __builtin_prefetch(sums + 2 * r.ahead + c, 0, 2);
        const __m512 dx = _mm512_set1_ps(r.dx[p]);
        for (std::ptrdiff_t c = 0; c < width; c += 16) {
            const __mmask16 mask = first_lanes(int(width - c)), stored = first_lanes(int(step - c));
            const __m512 offset = _mm512_fmadd_ps(dx, _mm512_maskz_loadu_ps(mask, r.slope + c),
                                                  _mm512_maskz_loadu_ps(mask, r.base + c));
            const __m512 sum = _mm512_add_ps(widened(sums + c, mask), offset);
            _mm256_mask_storeu_epi16(
                out + c, stored,
                (__m256i)_mm512_cvtneps_pbh(_mm512_max_ps(sum, _mm512_setzero_ps())));
        }
    }
}

}  // namespace
#endif

namespace avx512_bf16 {

bool there() {
#if defined(__x86_64__)
    // Compilers' names for processor features are younger than the instruction; avx512bf16 is known
    // to gcc 12 and clang 14.
    static const bool kThere =
        __builtin_cpu_supports("avx512bf16") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
        __builtin_cpu_supports("avx512vl") != 0 && __builtin_cpu_supports("avx512dq") != 0;
    return kThere;
#else
    return false;
#endif
}

const Bf16Kernels& bf16_kernels() {
#if defined(__x86_64__)
    static const Bf16Kernels kKernels{.name = "AVX512_BF16",
                                      .by_quads = true,
                                      .dot_area = dot_area,
                                      .pixels_to_bf16 = pixels_to_bf16,
                                      .row_to_bf16 = row_to_bf16,
                                      .compress_row = compress_row,
                                      .keep_row = keep_row,
                                      .update_row = update_row,
                                      .double_row = double_row,
                                      .offset_rows = offset_rows,
                                      .winograd_input = winograd_input,
                                      .winograd_output = winograd_output,
                                      .hidden_rows = hidden_rows};
    return kKernels;
#else
    return plain::bf16_kernels();
#endif
}

}  // namespace avx512_bf16

const Bf16Kernels* bf16_kernels(Instructions most) {
    if (const Bf16Kernels* amx = amx_kernels(most)) return amx;
    const bool is_allowed = most == Instructions::best || most == Instructions::avx512;
    return is_allowed && avx512_bf16::there() ? &avx512_bf16::bf16_kernels() : nullptr;
}

}  // namespace eventide
