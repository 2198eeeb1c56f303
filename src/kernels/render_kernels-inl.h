// See render_kernels.h.
#if defined(EVENTIDE_RENDER_KERNELS_INL_H) == \
    defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef EVENTIDE_RENDER_KERNELS_INL_H
#undef EVENTIDE_RENDER_KERNELS_INL_H
#else
#define EVENTIDE_RENDER_KERNELS_INL_H
#endif

#include "src/kernels/render_kernels.h"
#include "src/kernels/vector_maps-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eventide::HWY_NAMESPACE {

struct Offset {
    V dx;
    HWY_INLINE V operator()(V sum, V base, V slope, V) const {
        return hn::Max(hn::Add(sum, hn::MulAdd(dx, slope, base)), hn::Zero(D()));
    }
};
void offset_rows(const OffsetRows& r) {
    const std::ptrdiff_t width = r.width;
    constexpr std::ptrdiff_t kLine = 64 / sizeof(float);
    for (int p = 0; p < r.pixels; ++p) {
        const float* sums = static_cast<const float*>(r.sums) + r.column[p] * width;
        if (r.ahead != 0)
            for (std::ptrdiff_t c = 0; c < width; c += kLine)
                __builtin_prefetch(sums + r.ahead + c, 0, 2);
        map(Offset{hn::Set(D(), r.dx[p])}, std::size_t(width),
            static_cast<float*>(r.out) + p * width, sums, r.base, r.slope, r.base);
    }
}

/// Sums of products of a pixel, still spread over a vector; or of several, side by side.
struct PairOfSums {
    V first, second;
};
HWY_INLINE PairOfSums products_of(const TwoOutputs& r, int pixel) {
    const D d;
    const std::size_t lanes = hn::Lanes(d), n = std::size_t(r.width);
    const float* row = r.in + std::size_t(pixel) * n;
    V first = hn::Zero(d), second = hn::Zero(d);
    std::size_t k = 0;
    for (; k + lanes <= n; k += lanes) {
        const V value = hn::LoadU(d, row + k);
        first = hn::MulAdd(value, hn::LoadU(d, r.weight + k), first);
        second = hn::MulAdd(value, hn::LoadU(d, r.weight + n + k), second);
    }
    if (k < n) {
        const V value = load_some(row + k, n - k);
        first = hn::MulAdd(value, load_some(r.weight + k, n - k), first);
        second = hn::MulAdd(value, load_some(r.weight + n + k, n - k), second);
    }
    return {first, second};
}
/// Neighbouring lanes of a, then of b, added to each other.
HWY_INLINE V add_neighbours(V a, V b) {
#if HWY_TARGET == HWY_SCALAR  // a lane has no neighbour
    return hn::Add(a, b);
#else
    const D d;
    return hn::Add(hn::ConcatEven(d, b, a), hn::ConcatOdd(d, b, a));
#endif
}
/// kCount pixels' sums from pixel p on, each in its share of a vector's lanes; those past the last
/// are the last's again.
///
///     pixel p: a0 a1 a2 a3, pixel p + 1: b0 b1 b2 b3  ->  a01 a23 b01 b23
///     that, and c01 c23 d01 d23                       ->  a b c d
template <std::size_t kCount>
HWY_INLINE PairOfSums sums_of(const TwoOutputs& r, int p) {
    if constexpr (kCount == 1) {
        return products_of(r, std::min(p, r.pixels - 1));
    } else {
        const PairOfSums a = sums_of<kCount / 2>(r, p),
                         b = sums_of<kCount / 2>(r, p + int(kCount / 2));
        return {add_neighbours(a.first, b.first), add_neighbours(a.second, b.second)};
    }
}
void two_outputs(const TwoOutputs& r) {
    const D d;
    constexpr std::size_t kLanes = hn::MaxLanes(D());
    const V bias_first = hn::Set(d, r.bias[0]), bias_second = hn::Set(d, r.bias[1]);
    for (int p = 0; p < r.pixels; p += int(kLanes)) {
        const PairOfSums sums = sums_of<kLanes>(r, p);
        const int n = std::min(r.pixels - p, int(kLanes));
        store_some(hn::Add(sums.first, bias_first), r.first + p, n);
        store_some(hn::Add(sums.second, bias_second), r.second + p, n);
    }
}

struct Weighed {
    V weight;
    HWY_INLINE V operator()(V mu, V share, V, V) const {
        return hn::Mul(hn::Mul(weight, share), mu);
    }
};
struct WeighedLog {
    V weight, least, most;
    HWY_INLINE V operator()(V log_sigma, V share, V, V) const {
        return hn::Mul(hn::Mul(weight, share), hn::Min(hn::Max(log_sigma, least), most));
    }
};
struct WeighedSquare {
    V weight, least, most;
    HWY_INLINE V operator()(V log_sigma, V share, V mu, V) const {
        const V s = hn::Min(hn::Max(log_sigma, least), most);
        return hn::Mul(hn::Mul(weight, share), hn::MulAdd(mu, mu, exp_within(hn::Add(s, s))));
    }
};
void weigh_rows(const WeighRows& r) {
    const D d;
    const auto n = std::size_t(r.pixels);
    const V weight = hn::Set(d, r.weight), least = hn::Set(d, r.least), most = hn::Set(d, r.most);
    // The squares first: they read mu and log sigma, which the two lines below overwrite.
    if (r.square != nullptr)
        map(WeighedSquare{weight, least, most}, n, r.square, r.log_sigma, r.share, r.mu, r.mu);
    map(Weighed{weight}, n, r.mu, r.mu, r.share, r.share, r.share);
    map(WeighedLog{weight, least, most}, n, r.log_sigma, r.log_sigma, r.share, r.share, r.share);
}

struct ScaledExp {
    V scale;
    HWY_INLINE V operator()(V v, V, V, V) const { return hn::Mul(scale, exp_within(v)); }
};
void scaled_exp(const float* in, float scale, float* out, std::size_t n) {
    map(ScaledExp{hn::Set(D(), scale)}, n, out, in, in, in, in);
}

}  // namespace eventide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
