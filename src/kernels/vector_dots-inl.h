// Products of rows of numbers with packed weights: the inner loop of every convolution and layer.
#if defined(EVENTIDE_VECTOR_DOTS_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef EVENTIDE_VECTOR_DOTS_INL_H
#undef EVENTIDE_VECTOR_DOTS_INL_H
#else
#define EVENTIDE_VECTOR_DOTS_INL_H
#endif

#include "src/kernels/dot_blocks.h"
#include "src/kernels/vector_kernels.h"
#include "src/kernels/vectors-inl.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

HWY_BEFORE_NAMESPACE();
namespace eventide::HWY_NAMESPACE {

/// Sums of P pixels x (one or two) vectors of outputs, held in registers. A chain of structs and
/// not an array, because compilers keep members in registers and arrays often not.
template <int P, bool kTwo>
struct Sums {
    Sums<P - 1, kTwo> before;
    V a, b;

    HWY_INLINE void start(V bias_a, V bias_b) {
        before.start(bias_a, bias_b);
        a = bias_a;
        if (kTwo) b = bias_b;
    }
    HWY_INLINE void add(const float* in, std::ptrdiff_t step, V weight_a, V weight_b) {
        before.add(in, step, weight_a, weight_b);
        const V value = hn::Set(D(), in[(P - 1) * step]);
        a = hn::MulAdd(value, weight_a, a);
        if (kTwo) b = hn::MulAdd(value, weight_b, b);
    }
    HWY_INLINE void store(float* out, std::ptrdiff_t step, int outputs, V floor) const {
        before.store(out, step, outputs, floor);
        const int lanes = int(hn::Lanes(D()));
        store_some(hn::Max(a, floor), out + (P - 1) * step, std::min(outputs, lanes));
        if (kTwo) store_some(hn::Max(b, floor), out + (P - 1) * step + lanes, outputs - lanes);
    }
};
template <bool kTwo>
struct Sums<0, kTwo> {
    HWY_INLINE void start(V, V) {}
    HWY_INLINE void add(const float*, std::ptrdiff_t, V, V) {}
    HWY_INLINE void store(float*, std::ptrdiff_t, int, V) const {}
};

/// P pixels x one block of outputs.
template <int P, bool kTwo>
HWY_NOINLINE void dot_block(const DotRows& r, const float* in, const float* weight, int first,
                            float* out) {
    const D d;
    const std::size_t lanes = hn::Lanes(d);
    const float* bias = r.bias + first;
    Sums<P, kTwo> sums;
    sums.start(hn::LoadU(d, bias), hn::LoadU(d, bias + (kTwo ? lanes : 0)));
    for (int s = 0; s < r.stretches; ++s) {
        const float* from = in + s * r.pitch;
        for (int k = 0; k < r.length; ++k) {
            sums.add(from + k, r.step, hn::LoadU(d, weight),
                     hn::LoadU(d, weight + (kTwo ? lanes : 0)));
            weight += kTwo ? 2 * lanes : lanes;
        }
    }
    const V floor = hn::Set(d, r.relu ? 0.0F : -std::numeric_limits<float>::infinity());
    sums.store(out, r.out_step, r.outputs - first, floor);
}

/// 16 registers hold 6 x 2 sums beside two weights and a value, 32 hold 14 x 2.
constexpr int kMaxPixels =
    HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL || HWY_TARGET == HWY_NEON ? 14 : 6;

using Block = void (*)(const DotRows&, const float*, const float*, int, float*);
template <bool kTwo, int... P>
constexpr std::array<Block, sizeof...(P)> blocks(std::integer_sequence<int, P...>) {
    return {&dot_block<P + 1, kTwo>...};
}

void dot_rows(const DotRows& r) {
    static constexpr auto kOne = blocks<false>(std::make_integer_sequence<int, kMaxPixels>{});
    static constexpr auto kTwo = blocks<true>(std::make_integer_sequence<int, kMaxPixels>{});
    dot_in_blocks(r, int(hn::Lanes(D())), kOne, kTwo);
}

}  // namespace eventide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
