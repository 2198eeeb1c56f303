// See bf16_winograd.h, and vector_winograd-inl.h for the same sums of float32 numbers.
#include "src/kernels/bf16_winograd.h"

#include <limits>

#if defined(__x86_64__)
#include "src/kernels/bf16_vectors.h"
#endif

namespace eventide::avx512_bf16 {

#if defined(__x86_64__)
namespace {

/// The first `mask` lanes of v, rounded.
EVENTIDE_BF16_INLINE void put(std::uint16_t* to, __mmask16 mask, __m512 v) {
    _mm256_mask_storeu_epi16(to, mask, (__m256i)_mm512_cvtneps_pbh(v));
}

/// at(i): pixel i of the six. `plane`: numbers from position to position.
template <typename At>
EVENTIDE_BF16_INLINE void group_input(const At& at, __mmask16 mask, std::ptrdiff_t plane,
                                      std::uint16_t* out) {
    const __m512 d0 = widened(at(0), mask), d1 = widened(at(1), mask), d2 = widened(at(2), mask),
                 d3 = widened(at(3), mask), d4 = widened(at(4), mask), d5 = widened(at(5), mask);
    const __m512 a = _mm512_set1_ps(float(kWinogradA)), b = _mm512_set1_ps(float(kWinogradB)),
                 two = _mm512_set1_ps(2.0F), half = _mm512_set1_ps(0.5F),
                 most = _mm512_set1_ps(2.5F);
    put(out, mask, _mm512_fnmadd_ps(most, d2, _mm512_add_ps(d0, d4)));
    const __m512 even_a = _mm512_fnmadd_ps(two, d2, d4), odd_a = _mm512_fnmadd_ps(two, d1, d3);
    put(out + plane, mask, _mm512_fmadd_ps(a, odd_a, even_a));
    put(out + 2 * plane, mask, _mm512_fnmadd_ps(a, odd_a, even_a));
    const __m512 even_b = _mm512_fnmadd_ps(half, d2, d4), odd_b = _mm512_fnmadd_ps(half, d1, d3);
    put(out + 3 * plane, mask, _mm512_fmadd_ps(b, odd_b, even_b));
    put(out + 4 * plane, mask, _mm512_fnmadd_ps(b, odd_b, even_b));
    put(out + 5 * plane, mask, _mm512_fnmadd_ps(most, d3, _mm512_add_ps(d1, d5)));
}

/// The first `pixels` of a group's four outputs, of a vector of outputs.
EVENTIDE_BF16_INLINE void group_output(const WinogradOutput& r, const float* in, const float* bias,
                                       __mmask16 mask, int pixels, std::uint16_t* out) {
    const auto m = [&](int position) EVENTIDE_BF16 {
        return _mm512_maskz_loadu_ps(mask, in + position * r.plane);
    };
    const __m512 floor = _mm512_set1_ps(r.relu ? 0.0F : -std::numeric_limits<float>::infinity());
    const auto put_pixel = [&](int pixel, __m512 y) EVENTIDE_BF16 {
        if (pixel < pixels) put(out + 2 * pixel * r.out_step, mask, _mm512_max_ps(y, floor));
    };
    const __m512 m1 = m(1), m2 = m(2), m3 = m(3), m4 = m(4),
                 offset = _mm512_maskz_loadu_ps(mask, bias);
    const __m512 even_a = _mm512_add_ps(m1, m2), odd_a = _mm512_sub_ps(m1, m2),
                 even_b = _mm512_add_ps(m3, m4), odd_b = _mm512_sub_ps(m3, m4);
    const __m512 a = _mm512_set1_ps(float(kWinogradA)), b = _mm512_set1_ps(float(kWinogradB)),
                 half_a = _mm512_set1_ps(float(kWinogradA / 2)),
                 two_b = _mm512_set1_ps(float(2 * kWinogradB));
    put_pixel(0, _mm512_add_ps(_mm512_add_ps(_mm512_add_ps(m(0), offset), even_a), even_b));
    put_pixel(1, _mm512_fmadd_ps(b, odd_b, _mm512_fmadd_ps(a, odd_a, offset)));
    put_pixel(2, _mm512_fmadd_ps(_mm512_set1_ps(2.0F), even_b,
                                 _mm512_fmadd_ps(_mm512_set1_ps(0.5F), even_a, offset)));
    put_pixel(3, _mm512_fmadd_ps(two_b, odd_b,
                                 _mm512_fmadd_ps(half_a, odd_a, _mm512_add_ps(m(5), offset))));
}

}  // namespace

EVENTIDE_BF16 void winograd_input(const WinogradInput& r) {
    const std::ptrdiff_t channels = r.channels, plane = 2 * r.plane;
    auto* out = static_cast<std::uint16_t*>(r.out);
    for (int x = 0; x + kWinogradTaps <= r.pixels; x += kWinogradOutputs) {
        const std::uint16_t* in = static_cast<const std::uint16_t*>(r.in) + x * channels;
        const std::ptrdiff_t last = r.pixels - 1 - x;
        for (int y = 0; y < r.rows; ++y, in += 2 * r.pitch, out += 2 * r.step)
            for (std::ptrdiff_t c = 0; c < channels; c += 16) {
                const __mmask16 mask = first_lanes(int(channels - c));
                if (last >= kWinogradPositions - 1)
                    group_input([&](int i) { return in + i * channels + c; }, mask, plane, out + c);
                else
                    group_input(
                        [&](int i) {
                            return in + std::min<std::ptrdiff_t>(i, last) * channels + c;
                        },
                        mask, plane, out + c);
            }
    }
}

EVENTIDE_BF16 void winograd_output(const WinogradOutput& r) {
    const float* in = r.in;
    for (int x = 0; x < r.width; x += kWinogradOutputs) {
        const int pixels = std::min(kWinogradOutputs, r.width - x);
        auto* out = static_cast<std::uint16_t*>(r.out) + 2 * x * r.out_step;
        for (int y = 0; y < r.rows; ++y, in += r.outputs, out += 2 * r.out_pitch)
            for (int c = 0; c < r.outputs; c += 16)
                group_output(r, in + c, r.bias + c, first_lanes(r.outputs - c), pixels, out + c);
    }
}
#else
void winograd_input(const WinogradInput&) {}
void winograd_output(const WinogradOutput&) {}
#endif

}  // namespace eventide::avx512_bf16
