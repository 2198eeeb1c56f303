// The kernels of bf16_kernels.h by AVX512_BF16: their table, and those that go over rows of pixels.
#include "src/kernels/bf16_kernels.h"

#include "src/kernels/bf16_dots.h"
#include "src/kernels/bf16_render.h"
#include "src/kernels/bf16_winograd.h"
#include "src/kernels/pixels_to_bf16.h"

#include <algorithm>

#if defined(__x86_64__)
#include "src/kernels/bf16_vectors.h"
#endif

namespace eventide {

#if defined(__x86_64__)
namespace {

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
