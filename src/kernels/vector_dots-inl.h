// Products of rows of numbers with packed weights: the inner loop of every convolution and layer.
#if defined(EVENTIDE_VECTOR_DOTS_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef EVENTIDE_VECTOR_DOTS_INL_H
#undef EVENTIDE_VECTOR_DOTS_INL_H
#else
#define EVENTIDE_VECTOR_DOTS_INL_H
#endif

#include "src/kernels/dot_blocks.h"
#include "src/kernels/quad_dots.h"
#include "src/kernels/vector_kernels.h"
#include "src/kernels/vectors-inl.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

HWY_BEFORE_NAMESPACE();
namespace eventide::HWY_NAMESPACE {

/// Layers of no more outputs than this use vectors of so many lanes, so that none is computed for
/// nothing.
using Narrow = hn::CappedTag<float, kNarrowLanes>;

/// Sums of P pixels x (one or two) vectors of outputs, held in registers. A chain of structs and
/// not an array, because compilers keep members in registers and arrays often not.
///
/// Registers of AVX2 with P = 6 and two vectors of 8 outputs, at one unit k of a stretch:
///
///     weights of unit k          w0 .. w7    w8 .. w15
///     pixel 0: in[0 step + k]    a           b              sum += in w, in every lane
///     pixel 1: in[1 step + k]    a           b
///       ...
///     pixel 5: in[5 step + k]    a           b              12 sums, 2 weights, 1 number: 15 of 16
///
/// Sums<P> holds those of pixel P - 1, and in `before` those of the pixels before it.
template <class Tag, int P, bool kTwo>
struct Sums {
    using Vector = hn::Vec<Tag>;
    Sums<Tag, P - 1, kTwo> before;
    Vector a, b;

    HWY_INLINE Sums() {}  // gcc compiles one of its own for another target than NEON
    HWY_INLINE void start(Vector bias_a, Vector bias_b) {
        before.start(bias_a, bias_b);
        a = bias_a;
        if (kTwo) b = bias_b;
    }
    HWY_INLINE void add(const float* in, std::ptrdiff_t step, Vector weight_a, Vector weight_b) {
        before.add(in, step, weight_a, weight_b);
        const Vector value = hn::Set(Tag(), in[(P - 1) * step]);
        a = hn::MulAdd(value, weight_a, a);
        if (kTwo) b = hn::MulAdd(value, weight_b, b);
    }
    /// visit(pixel, a, b) from pixel 0 on.
    template <typename Visit>
    HWY_INLINE void each(const Visit& visit) const {
        before.each(visit);
        visit(P - 1, a, b);
    }
    HWY_INLINE void store(float* out, std::ptrdiff_t step, int outputs, Vector floor) const {
        before.store(out, step, outputs, floor);
        const int lanes = int(hn::Lanes(Tag()));
        store_some(Tag(), hn::Max(a, floor), out + (P - 1) * step, std::min(outputs, lanes));
        if (kTwo)
            store_some(Tag(), hn::Max(b, floor), out + (P - 1) * step + lanes, outputs - lanes);
    }
};
template <class Tag, bool kTwo>
struct Sums<Tag, 0, kTwo> {
    using Vector = hn::Vec<Tag>;
    HWY_INLINE void start(Vector, Vector) {}
    HWY_INLINE void add(const float*, std::ptrdiff_t, Vector, Vector) {}
    template <typename Visit>
    HWY_INLINE void each(const Visit&) const {}
    HWY_INLINE void store(float*, std::ptrdiff_t, int, Vector) const {}
};

/// P pixels x one block of outputs.
template <class Tag, int P, bool kTwo>
HWY_NOINLINE void dot_block(const DotArea& r, const float* weight, int y, int x, int first) {
    const Tag d;
    const std::size_t lanes = hn::Lanes(d);
    const float* bias = r.bias + first;
    Sums<Tag, P, kTwo> sums;
    // Of one vector `b` is never used; what is loaded for it is the first vector again, so that
    // nothing past the end is read.
    sums.start(hn::LoadU(d, bias), hn::LoadU(d, bias + (kTwo ? lanes : 0)));
    for (int s = 0; s < r.count; ++s) {
        const Stretch& stretch = r.stretches[s];
        const std::ptrdiff_t step = stretch.step;
        const float* from = static_cast<const float*>(stretch.in) + y * stretch.pitch + x * step;
        // Weights go by unit after unit, `width` numbers each, over all stretches.
        const std::size_t second = kTwo ? lanes : 0, width = lanes + second;
        // Four at a time: stretches are short, and the end of each loop costs a wrong guess.
        int k = 0;
        for (; k + 4 <= stretch.length; k += 4, weight += 4 * width)
            for (std::size_t i = 0; i < 4; ++i)
                sums.add(from + k + i, step, hn::LoadU(d, weight + i * width),
                         hn::LoadU(d, weight + i * width + second));
        for (; k < stretch.length; ++k, weight += width)
            sums.add(from + k, step, hn::LoadU(d, weight), hn::LoadU(d, weight + second));
    }
    // max(sum, floor): a ReLU, or nothing.
    const auto floor = hn::Set(d, r.relu ? 0.0F : -std::numeric_limits<float>::infinity());
    sums.store(static_cast<float*>(r.out) + y * r.out_pitch + x * r.out_step + first, r.out_step,
               r.outputs - first, floor);
}

/// 16 registers hold 6 x 2 sums beside two weights and a value, or 12 beside one; 32 hold 14 x 2
/// or 18. Fewer than 8 sums would wait for each other.
constexpr bool kManyRegisters =
    HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL || HWY_TARGET == HWY_NEON;
constexpr int kMaxPixels = kManyRegisters ? 18 : 12, kMaxPixelsOfTwo = kManyRegisters ? 14 : 6;

using Block = void (*)(const DotArea&, const float*, int, int, int);
template <class Tag, bool kTwo, int... P>
constexpr std::array<Block, sizeof...(P)> blocks(std::integer_sequence<int, P...>) {
    return {&dot_block<Tag, P + 1, kTwo>...};
}

template <class Tag>
void dot_area_by(const DotArea& r) {
    static constexpr auto kOne = blocks<Tag, false>(std::make_integer_sequence<int, kMaxPixels>{});
    static constexpr auto kTwo =
        blocks<Tag, true>(std::make_integer_sequence<int, kMaxPixelsOfTwo>{});
    dot_in_blocks<float>(r, int(hn::Lanes(Tag())), kOne, kTwo);
}

/// Quads take four pixels x four outputs in the 16 lanes that these targets have.
constexpr bool kByQuads = HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL;

void dot_area(const DotArea& r) {
    if (kByQuads && avx512::takes_quads(r)) {
        avx512::dot_quads_f32(r);
        return;
    }
    r.lanes == int(hn::Lanes(D())) ? dot_area_by<D>(r) : dot_area_by<Narrow>(r);
}

}  // namespace eventide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
