// See vector_kernels.h. This text is compiled once per instruction set (foreach_target.h).
#include "src/kernels/vector_kernels.h"

#include "src/kernels/dot_blocks.h"

// Vectors of unknown length cannot be members of a struct, which the register blocks here are.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/kernels/vector_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// Highway's maths after highway.h: it follows the target.
#include <hwy/contrib/math/math-inl.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <utility>

HWY_BEFORE_NAMESPACE();
namespace eventide::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<float>;
using V = hn::Vec<D>;

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
    static HWY_INLINE void store_some(V v, float* out, int n) {
        const D d;
        if (n >= int(hn::Lanes(d))) {
            hn::StoreU(v, d, out);
            return;
        }
        HWY_ALIGN float whole[HWY_MAX_BYTES / sizeof(float)];
        hn::Store(v, d, whole);
        for (int i = 0; i < n; ++i) out[i] = whole[i];
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

/// Calls body(vector, vector out)-like step over n numbers, the rest through a short copy, so that
/// nothing outside is read or written.
template <typename Step>
HWY_INLINE void over(std::size_t n, Step step) {
    const std::size_t lanes = hn::Lanes(D());
    std::size_t i = 0;
    for (; i + lanes <= n; i += lanes) step.whole(i);
    if (i < n) step.some(i, n - i);
}
HWY_INLINE V load_some(const float* from, std::size_t n) {
    HWY_ALIGN float whole[HWY_MAX_BYTES / sizeof(float)] = {};
    std::memcpy(whole, from, n * sizeof(float));
    return hn::Load(D(), whole);
}

/// One function of up to four inputs, number by number.
template <typename Function>
HWY_INLINE void map(Function function, std::size_t n, float* out, const float* a, const float* b,
                    const float* c, const float* d) {
    struct Step {
        Function function;
        float* out;
        const float *a, *b, *c, *d;
        HWY_INLINE void whole(std::size_t i) {
            const D tag;
            hn::StoreU(function(hn::LoadU(tag, a + i), hn::LoadU(tag, b + i), hn::LoadU(tag, c + i),
                                hn::LoadU(tag, d + i)),
                       tag, out + i);
        }
        HWY_INLINE void some(std::size_t i, std::size_t n) {
            Sums<1, false>::store_some(function(load_some(a + i, n), load_some(b + i, n),
                                                load_some(c + i, n), load_some(d + i, n)),
                                       out + i, int(n));
        }
    };
    over(n, Step{function, out, a, b, c, d});
}

/// Beyond this exp saturates in both functions to within float's last place.
HWY_INLINE V exp_within(V v) {
    const D d;
    return hn::Exp(d, hn::Min(hn::Max(v, hn::Set(d, -40.0F)), hn::Set(d, 40.0F)));
}
HWY_INLINE V sigmoid(V v) {
    const V one = hn::Set(D(), 1.0F);
    return hn::Div(one, hn::Add(one, exp_within(hn::Neg(v))));
}
/// 1 - 2 / (1 + exp(2 v)): absolute error of a few 1e-7, which is what a state near 1 has anyway.
HWY_INLINE V tanh(V v) {
    const D d;
    const V one = hn::Set(d, 1.0F);
    return hn::Sub(one, hn::Div(hn::Set(d, 2.0F), hn::Add(one, exp_within(hn::Add(v, v)))));
}
HWY_INLINE V elu_of(V v) {
    const D d;
    const V zero = hn::Zero(d);
    const V below = hn::Expm1(d, hn::Max(hn::Min(v, zero), hn::Set(d, -40.0F)));
    return hn::IfThenElse(hn::Gt(v, zero), v, below);
}

struct Compress {
    HWY_INLINE V operator()(V v, V, V, V) const {
        const D d;
        const V size = hn::Abs(v);
        if (hn::AllTrue(d, hn::Eq(size, hn::Zero(d)))) return v;  // most of a grid
        return hn::CopySign(hn::Log1p(d, size), v);
    }
};
struct ResetState {
    HWY_INLINE V operator()(V r, V h, V, V) const { return hn::Mul(sigmoid(r), h); }
};
struct UpdateState {
    HWY_INLINE V operator()(V h, V u, V c, V) const {
        return hn::MulAdd(sigmoid(u), hn::Sub(tanh(c), h), h);
    }
};
struct AddRelu {
    HWY_INLINE V operator()(V a, V b, V, V) const { return hn::Max(hn::Add(a, b), hn::Zero(D())); }
};
struct NormElu {
    HWY_INLINE V operator()(V v, V scale, V shift, V skip) const {
        return elu_of(hn::Add(hn::MulAdd(v, scale, shift), skip));
    }
};
struct NormEluAlone {
    HWY_INLINE V operator()(V v, V scale, V shift, V) const {
        return elu_of(hn::MulAdd(v, scale, shift));
    }
};
struct Elu {
    HWY_INLINE V operator()(V v, V, V, V) const { return elu_of(v); }
};
struct Average {
    HWY_INLINE V operator()(V a, V b, V c, V d) const {
        return hn::Mul(hn::Add(hn::Add(a, b), hn::Add(c, d)), hn::Set(D(), 0.25F));
    }
};

void compress(const float* in, float* out, std::size_t n) {
    map(Compress{}, n, out, in, in, in, in);
}
void reset_state(const float* r, float* h, int channels) {
    map(ResetState{}, std::size_t(channels), h, r, h, h, h);
}
void update_state(const float* h, const float* u, const float* c, float* out, int channels) {
    map(UpdateState{}, std::size_t(channels), out, h, u, c, c);
}
void add_relu(const float* a, const float* b, float* out, std::size_t n) {
    map(AddRelu{}, n, out, a, b, a, a);
}
void norm_elu(const float* a, const float* scale, const float* shift, const float* skip, float* out,
              std::size_t pixels, int channels) {
    const auto count = std::size_t(channels);
    for (std::size_t p = 0; p < pixels; ++p) {
        const std::size_t at = p * count;
        if (skip != nullptr)
            map(NormElu{}, count, out + at, a + at, scale, shift, skip + at);
        else
            map(NormEluAlone{}, count, out + at, a + at, scale, shift, shift);
    }
}
void elu(const float* in, float* out, std::size_t n) {
    map(Elu{}, n, out, in, in, in, in);
}
void average(const float* a, const float* b, const float* c, const float* d, float* out, int n) {
    map(Average{}, std::size_t(n), out, a, b, c, d);
}

struct Offset {
    V dx;
    HWY_INLINE V operator()(V sum, V base, V slope, V) const {
        return hn::Max(hn::Add(sum, hn::MulAdd(dx, slope, base)), hn::Zero(D()));
    }
};
void offset_rows(const OffsetRows& r) {
    const std::ptrdiff_t width = r.width;
    for (int p = 0; p < r.pixels; ++p)
        map(Offset{hn::Set(D(), r.dx[p])}, std::size_t(width), r.out + p * width,
            r.sums + r.column[p] * width, r.base, r.slope, r.base);
}

void two_outputs(const float* in, const float* weight, const float* bias, int pixels, int width,
                 float* out) {
    const D d;
    const std::size_t lanes = hn::Lanes(d), n = std::size_t(width);
    for (int p = 0; p < pixels; ++p) {
        const float* row = in + std::size_t(p) * n;
        V first = hn::Zero(d), second = hn::Zero(d);
        std::size_t k = 0;
        for (; k + lanes <= n; k += lanes) {
            const V value = hn::LoadU(d, row + k);
            first = hn::MulAdd(value, hn::LoadU(d, weight + k), first);
            second = hn::MulAdd(value, hn::LoadU(d, weight + n + k), second);
        }
        if (k < n) {
            const V value = load_some(row + k, n - k);
            first = hn::MulAdd(value, load_some(weight + k, n - k), first);
            second = hn::MulAdd(value, load_some(weight + n + k, n - k), second);
        }
        out[2 * p] = bias[0] + hn::GetLane(hn::SumOfLanes(d, first));
        out[2 * p + 1] = bias[1] + hn::GetLane(hn::SumOfLanes(d, second));
    }
}

const VectorKernels* table() {
    static const VectorKernels kTable{hwy::TargetName(HWY_TARGET),
                                      int(hn::Lanes(D())),
                                      dot_rows,
                                      compress,
                                      reset_state,
                                      update_state,
                                      add_relu,
                                      norm_elu,
                                      elu,
                                      average,
                                      offset_rows,
                                      two_outputs};
    return &kTable;
}

}  // namespace eventide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eventide {
namespace {

HWY_EXPORT(table);
bool g_limited = false;

void leave_out(std::int64_t targets) {
    g_limited = true;
    hwy::DisableTargets(targets);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace

const VectorKernels& vector_kernels() {
    return *HWY_DYNAMIC_DISPATCH(table)();
}

void limit_kernels_to_avx2() {
    leave_out(HWY_AVX3 | HWY_AVX3_DL);
}
void limit_kernels_to_sse4() {
    leave_out(HWY_AVX2 | HWY_AVX3 | HWY_AVX3_DL);
}

bool kernels_limited() {
    return g_limited;
}

std::size_t packed_size(int stretches, int length, int outputs, int lanes) {
    const int padded = (outputs + lanes - 1) / lanes * lanes;
    return std::size_t(stretches) * std::size_t(length) * std::size_t(padded);
}

}  // namespace eventide
#endif
