// Functions of up to four rows of numbers, number by number.
#if defined(EVENTIDE_VECTOR_MAPS_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef EVENTIDE_VECTOR_MAPS_INL_H
#undef EVENTIDE_VECTOR_MAPS_INL_H
#else
#define EVENTIDE_VECTOR_MAPS_INL_H
#endif

#include "src/kernels/vectors-inl.h"

// Highway's maths after highway.h: it follows the target.
#include <hwy/contrib/math/math-inl.h>

HWY_BEFORE_NAMESPACE();
namespace eventide::HWY_NAMESPACE {

/// step.whole(i) for each full vector of n numbers, step.some(i, rest) for what is left, so that
/// nothing outside is read or written.
template <typename Step>
HWY_INLINE void over(std::size_t n, Step step) {
    const std::size_t lanes = hn::Lanes(D());
    std::size_t i = 0;
    for (; i + lanes <= n; i += lanes) step.whole(i);
    if (i < n) step.some(i, n - i);
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
            store_some(function(load_some(a + i, n), load_some(b + i, n), load_some(c + i, n),
                                load_some(d + i, n)),
                       out + i, int(n));
        }
    };
    over(n, Step{function, out, a, b, c, d});
}

/// exp(v) of v within +-40, to within 2e-7 of itself; beyond, both functions below are saturated to
/// float's last place. v = n ln 2 + f, exp(f) = 1 + f + f^2 P(f), P
/// as Cephes has it.
template <class Vector>
HWY_INLINE Vector exp_within(Vector v) {
    const hn::DFromV<Vector> d;
    const hn::RebindToSigned<decltype(d)> i;
    constexpr float kP[] = {1.9875691500e-4F, 1.3981999507e-3F, 8.3334519073e-3F,
                            4.1665795894e-2F, 1.6666665459e-1F, 5.0000001201e-1F};
    // ln 2 in two parts. The first is 355 / 512: its products with whole numbers as small as n are
    // exact in float32.
    constexpr float kLn2High = 0.693359375F, kLn2Low = -2.12194440e-4F, kLog2E = 1.44269504F;
    const Vector x = hn::Min(hn::Max(v, hn::Set(d, -40.0F)), hn::Set(d, 40.0F));
    const auto n = hn::NearestInt(hn::Mul(x, hn::Set(d, kLog2E)));
    const Vector whole = hn::ConvertTo(d, n);
    const Vector f =
        hn::NegMulAdd(whole, hn::Set(d, kLn2Low), hn::NegMulAdd(whole, hn::Set(d, kLn2High), x));
    Vector p = hn::Set(d, kP[0]);
    for (std::size_t k = 1; k < 6; ++k) p = hn::MulAdd(p, f, hn::Set(d, kP[k]));
    p = hn::MulAdd(hn::Mul(f, f), p, hn::Add(f, hn::Set(d, 1.0F)));
    // 2^n: n + 127 where float32 has its exponent.
    const auto exponent = hn::ShiftLeft<23>(hn::Add(n, hn::Set(i, 127)));
    return hn::Mul(p, hn::BitCast(d, exponent));
}
template <class Vector>
HWY_INLINE Vector sigmoid(Vector v) {
    const Vector one = hn::Set(hn::DFromV<Vector>(), 1.0F);
    return hn::Div(one, hn::Add(one, exp_within(hn::Neg(v))));
}
/// 1 - 2 / (1 + exp(2 v)): absolute error of a few 1e-7, which is what a state near 1 has anyway.
template <class Vector>
HWY_INLINE Vector tanh(Vector v) {
    const hn::DFromV<Vector> d;
    const Vector one = hn::Set(d, 1.0F);
    return hn::Sub(one, hn::Div(hn::Set(d, 2.0F), hn::Add(one, exp_within(hn::Add(v, v)))));
}
HWY_INLINE V elu_of(V v) {
    const D d;
    const V zero = hn::Zero(d);
    const V below = hn::Expm1(d, hn::Max(hn::Min(v, zero), hn::Set(d, -40.0F)));
    return hn::IfThenElse(hn::Gt(v, zero), v, below);
}

/// log(1 + x), x >= 0, within 3e-7 of 1 or of itself. 1 + x = 2^e (1 + f), f about 0; what its
/// rounding lost is added to f, and log(1 + f) = f - f^2 / 2 + f^3 P(f), P through Chebyshev's
/// nodes.
HWY_INLINE V log1p_of(V x) {
    const D d;
    const hn::RebindToSigned<D> i;
    constexpr float kP[] = {-0.07902743770578903F, 0.12622319847563748F,  -0.12998183763523533F,
                            0.1421449592417135F,   -0.16641281463144272F, 0.20001045094153552F,
                            -0.25000306422568747F, 0.33333330728190674F};
    constexpr float kLn2High = 0.693359375F, kLn2Low = -2.12194440e-4F;
    const V one = hn::Set(d, 1.0F), y = hn::Add(one, x), lost = hn::Sub(x, hn::Sub(y, one));
    const auto bits = hn::BitCast(i, y);
    // e such that m = y 2^-e lies from sqrt(1/2) to sqrt(2), hence f from -.29 to .41.
    const auto e = hn::ShiftRight<23>(hn::Sub(bits, hn::Set(i, 0x3f3504f3)));  // of sqrt(1/2)
    // Less this, y's bits are those of m; less this, those of 1 are `scale`, 2^-e.
    const auto exponent = hn::ShiftLeft<23>(e);
    const V m = hn::BitCast(d, hn::Sub(bits, exponent)),
            scale = hn::BitCast(d, hn::Sub(hn::Set(i, 127 << 23), exponent));
    const V f = hn::MulAdd(lost, scale, hn::Sub(m, one));
    V p = hn::Set(d, kP[0]);
    for (std::size_t k = 1; k < 8; ++k) p = hn::MulAdd(p, f, hn::Set(d, kP[k]));
    const V e_float = hn::ConvertTo(d, e), square = hn::Mul(f, f);
    const V tail = hn::MulAdd(square, hn::MulAdd(f, p, hn::Set(d, -0.5F)),
                              hn::Mul(e_float, hn::Set(d, kLn2Low)));
    return hn::MulAdd(e_float, hn::Set(d, kLn2High), hn::Add(f, tail));
}

struct Compress {
    HWY_INLINE V operator()(V v, V, V, V) const {
        const D d;
        const V size = hn::Abs(v);
        if (hn::AllTrue(d, hn::Eq(size, hn::Zero(d)))) return v;  // most of a grid
        return hn::CopySign(log1p_of(size), v);
    }
};
/// body(first channel, number of channels) over the channels of one pixel: whole vectors, then what
/// is left.
template <class Tag, typename Body>
HWY_INLINE void over_channels(Tag d, int channels, Body body) {
    const int lanes = int(hn::Lanes(d));
    int c = 0;
    for (; c + lanes <= channels; c += lanes) body(c, lanes);
    if (c < channels) body(c, channels - c);
}
/// n numbers: a whole vector of them in one go, fewer as load_some() takes them.
template <class Tag>
HWY_INLINE hn::Vec<Tag> load_upto(Tag d, const float* from, int n) {
    return n >= int(hn::Lanes(d)) ? hn::LoadU(d, from) : load_some(d, from, std::size_t(n));
}

/// out = r h, of pixels of C channels. `r` is the second half of what the gates' layer puts out, so
/// its pixels lie 2 C apart; where C fills a vector (8 here), a pixel is one product:
///
///     gates    u0 .. u7  r0 .. r7 | u0 .. u7  r0 .. r7 | ...    r_step 16
///     h        h0 .. h7           | h0 .. h7           | ...    one after the other, as `out`
template <class Tag>
HWY_INLINE void reset_pixels(Tag d, const float* r, std::ptrdiff_t r_step, const float* h,
                             float* out, int channels, int pixels) {
    if (channels == int(hn::Lanes(d))) {
        for (int p = 0; p < pixels; ++p, r += r_step, h += channels, out += channels)
            hn::StoreU(hn::Mul(hn::LoadU(d, r), hn::LoadU(d, h)), d, out);
        return;
    }
    for (int p = 0; p < pixels; ++p, r += r_step, h += channels, out += channels)
        over_channels(d, channels, [&](int c, int n) HWY_ATTR {
            store_some(d, hn::Mul(load_upto(d, r + c, n), load_upto(d, h + c, n)), out + c, n);
        });
}
/// out = h + u (c - h), by one fused multiply-add a number, of pixels of C channels whose numbers
/// lie u_step and step apart; c = candidate(number).
template <class Tag, class Candidate>
HWY_INLINE void update_pixels(Tag d, const float* h, const float* u, std::ptrdiff_t u_step,
                              const float* from, std::ptrdiff_t step, const Candidate& candidate,
                              float* out, int channels, int pixels) {
    const auto updated = [&](auto old, auto share, auto number) HWY_ATTR {
        return hn::MulAdd(share, hn::Sub(candidate(number), old), old);
    };
    const bool is_whole = channels == int(hn::Lanes(d));
    for (int p = 0; p < pixels; ++p, u += u_step, from += step, h += channels, out += channels) {
        if (is_whole) {
            hn::StoreU(updated(hn::LoadU(d, h), hn::LoadU(d, u), hn::LoadU(d, from)), d, out);
            continue;
        }
        over_channels(d, channels, [&](int c, int n) HWY_ATTR {
            const auto old = load_upto(d, h + c, n), share = load_upto(d, u + c, n);
            store_some(d, updated(old, share, load_upto(d, from + c, n)), out + c, n);
        });
    }
}
struct AsItIs {
    template <class Vector>
    HWY_INLINE Vector operator()(Vector v) const {
        return v;
    }
};
/// 2 s - 1: tanh(v) of s = sigmoid(2 v).
struct TanhOfSigmoid {
    template <class Vector>
    HWY_INLINE Vector operator()(Vector s) const {
        const hn::DFromV<Vector> d;
        return hn::MulSub(hn::Set(d, 2.0F), s, hn::Set(d, 1.0F));
    }
};
struct Sigmoid {
    HWY_INLINE V operator()(V v, V, V, V) const { return sigmoid(v); }
};
struct Tanh {
    HWY_INLINE V operator()(V v, V, V, V) const { return tanh(v); }
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
/// Channels c to c + Lanes(d) of a DoubleRow. Sample by sample, for the two pixels that it is left
/// of: the one on it, and the one before the next.
///
///     samples     s0        s1        s2 (the last)
///     column      c0        c1        c2               c = above + under
///     pixels      0    1    2    3    4    5
///     4 out       c0   c0   c1   c1   c2   c2
///               + c0   c1   c1   c2   c2   c2
template <class Tag>
HWY_INLINE void double_channels(Tag d, const DoubleRow& r, std::ptrdiff_t c) {
    const std::ptrdiff_t n = r.channels;
    const auto *above = static_cast<const float*>(r.above) + c,
               *under = static_cast<const float*>(r.under) + c;
    // Where pixel 0 of the row would be, so that pixels are counted as the row counts them.
    auto* const out = static_cast<float*>(r.out) + c - r.x0 * n;
    const auto quarter = hn::Set(d, 0.25F);
    const auto column = [&](int sample) HWY_ATTR {
        return hn::Add(hn::LoadU(d, above + sample * n), hn::LoadU(d, under + sample * n));
    };
    auto left = column(r.x0 / 2);
    for (int sample = r.x0 / 2; 2 * sample < r.x1; ++sample) {
        const auto right = column(std::min(sample + 1, r.last));
        if (2 * sample >= r.x0)
            hn::StoreU(hn::Mul(hn::Add(left, left), quarter), d, out + 2 * sample * n);
        if (2 * sample + 1 < r.x1)
            hn::StoreU(hn::Mul(hn::Add(left, right), quarter), d, out + (2 * sample + 1) * n);
        left = right;
    }
}

}  // namespace eventide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
