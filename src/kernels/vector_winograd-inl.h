// The sums of winograd.h, for a vector of channels at a time.
#if defined(EVENTIDE_VECTOR_WINOGRAD_INL_H) == \
    defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef EVENTIDE_VECTOR_WINOGRAD_INL_H
#undef EVENTIDE_VECTOR_WINOGRAD_INL_H
#else
#define EVENTIDE_VECTOR_WINOGRAD_INL_H
#endif

#include "src/kernels/vectors-inl.h"
#include "src/kernels/winograd.h"

#include <algorithm>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace eventide::HWY_NAMESPACE {

/// body(first channel) of vectors that cover all channels: the last one ends with them, and covers
/// some of the one before again, to the same bits.
///
///     21 channels, vectors of 8     0 .. 7   8 .. 15   13 .. 20
template <class Tag, class Body>
HWY_INLINE void channel_vectors(Tag d, int channels, const Body& body) {
    const int lanes = int(hn::Lanes(d));
    for (int c = 0; c < channels; c += lanes) body(std::min(c, channels - lanes));
}
/// body(tag) with the widest vector that is no wider than the pixels.
template <class Body>
HWY_INLINE void by_width(int channels, const Body& body) {
    const auto fits = [&](auto d) HWY_ATTR { return channels >= int(hn::Lanes(d)); };
    if (fits(D())) return body(D());
    if (fits(hn::CappedTag<float, 8>())) return body(hn::CappedTag<float, 8>());
    if (fits(hn::CappedTag<float, 4>())) return body(hn::CappedTag<float, 4>());
    body(hn::CappedTag<float, 1>());
}

/// at(i): pixel i of the six, of the channels from the vector's first on.
template <class Tag, class At>
HWY_INLINE void group_input(Tag d, const At& at, std::ptrdiff_t plane, float* out) {
    const auto d0 = hn::LoadU(d, at(0)), d1 = hn::LoadU(d, at(1)), d2 = hn::LoadU(d, at(2)),
               d3 = hn::LoadU(d, at(3)), d4 = hn::LoadU(d, at(4)), d5 = hn::LoadU(d, at(5));
    const auto a = hn::Set(d, float(kWinogradA)), b = hn::Set(d, float(kWinogradB)),
               two = hn::Set(d, 2.0F), half = hn::Set(d, 0.5F), most = hn::Set(d, 2.5F);
    const auto put = [&](int position, auto v)
                         HWY_ATTR { hn::StoreU(v, d, out + position * plane); };
    put(0, hn::NegMulAdd(most, d2, hn::Add(d0, d4)));
    const auto even_a = hn::NegMulAdd(two, d2, d4), odd_a = hn::NegMulAdd(two, d1, d3);
    put(1, hn::MulAdd(a, odd_a, even_a));
    put(2, hn::NegMulAdd(a, odd_a, even_a));
    const auto even_b = hn::NegMulAdd(half, d2, d4), odd_b = hn::NegMulAdd(half, d1, d3);
    put(3, hn::MulAdd(b, odd_b, even_b));
    put(4, hn::NegMulAdd(b, odd_b, even_b));
    put(5, hn::NegMulAdd(most, d3, hn::Add(d1, d5)));
}

template <class Tag>
void winograd_input_by(Tag d, const WinogradInput& r) {
    const std::ptrdiff_t channels = r.channels;
    auto* out = static_cast<float*>(r.out);
    for (int x = 0; x + kWinogradTaps <= r.pixels; x += kWinogradOutputs) {
        const float* in = static_cast<const float*>(r.in) + x * channels;
        const std::ptrdiff_t last = r.pixels - 1 - x;
        for (int y = 0; y < r.rows; ++y, in += r.pitch, out += r.step)
            channel_vectors(d, r.channels, [&](int c) HWY_ATTR {
                const auto put = [&](const auto& at)
                                     HWY_ATTR { group_input(d, at, r.plane, out + c); };
                if (last >= kWinogradPositions - 1)
                    put([&](int i) { return in + i * channels + c; });
                else
                    put([&](int i) {
                        return in + std::min<std::ptrdiff_t>(i, last) * channels + c;
                    });
            });
    }
}
void winograd_input(const WinogradInput& r) {
    by_width(r.channels, [&](auto d) HWY_ATTR { winograd_input_by(d, r); });
}

/// The first `pixels` of a group's four outputs, of a vector of outputs from `c` on.
template <class Tag>
HWY_INLINE void group_output(Tag d, const WinogradOutput& r, const float* in, int c, int pixels,
                             float* out) {
    const auto m = [&](int position) HWY_ATTR { return hn::LoadU(d, in + position * r.plane + c); };
    const auto floor = hn::Set(d, r.relu ? 0.0F : -std::numeric_limits<float>::infinity());
    const auto put = [&](int pixel, auto y) HWY_ATTR {
        if (pixel < pixels) hn::StoreU(hn::Max(y, floor), d, out + pixel * r.out_step + c);
    };
    const auto m1 = m(1), m2 = m(2), m3 = m(3), m4 = m(4), bias = hn::LoadU(d, r.bias + c);
    const auto even_a = hn::Add(m1, m2), odd_a = hn::Sub(m1, m2), even_b = hn::Add(m3, m4),
               odd_b = hn::Sub(m3, m4);
    const auto a = hn::Set(d, float(kWinogradA)), b = hn::Set(d, float(kWinogradB)),
               half_a = hn::Set(d, float(kWinogradA / 2)),
               two_b = hn::Set(d, float(2 * kWinogradB));
    put(0, hn::Add(hn::Add(hn::Add(m(0), bias), even_a), even_b));
    put(1, hn::MulAdd(b, odd_b, hn::MulAdd(a, odd_a, bias)));
    put(2, hn::MulAdd(hn::Set(d, 2.0F), even_b, hn::MulAdd(hn::Set(d, 0.5F), even_a, bias)));
    put(3, hn::MulAdd(two_b, odd_b, hn::MulAdd(half_a, odd_a, hn::Add(m(5), bias))));
}

template <class Tag>
void winograd_output_by(Tag d, const WinogradOutput& r) {
    const float* in = r.in;
    for (int x = 0; x < r.width; x += kWinogradOutputs) {
        const int pixels = std::min(kWinogradOutputs, r.width - x);
        float* out = static_cast<float*>(r.out) + x * r.out_step;
        for (int y = 0; y < r.rows; ++y, in += r.outputs, out += r.out_pitch)
            channel_vectors(d, r.outputs,
                            [&](int c) HWY_ATTR { group_output(d, r, in, c, pixels, out); });
    }
}
void winograd_output(const WinogradOutput& r) {
    by_width(r.outputs, [&](auto d) HWY_ATTR { winograd_output_by(d, r); });
}

}  // namespace eventide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
