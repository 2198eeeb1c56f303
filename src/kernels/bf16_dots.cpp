// See bf16_dots.h. Highway has no bf16 product for these processors yet, hence intrinsics; they are
// compiled for their instruction set function by function and called only where it is there.
#include "src/kernels/bf16_dots.h"

#include "src/kernels/bf16_kernels.h"
#include "src/kernels/dot_blocks.h"
#include "src/kernels/quad_dots.h"

#include <array>
#include <limits>
#include <utility>

#if defined(__x86_64__)
#include "src/kernels/bf16_vectors.h"
#endif

namespace eventide::avx512_bf16 {

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

}  // namespace

void dot_area(const DotArea& r) {
    if (avx512::takes_quads(r)) {
        avx512::dot_quads_bf16(r);
        return;
    }
    bf16_lanes(r.outputs) == Narrow::kLanes ? dot_area_by<Narrow>(r) : dot_area_by<Wide>(r);
}
#else
// Never called: there() says no.
void dot_area(const DotArea&) {}
#endif

}  // namespace eventide::avx512_bf16
