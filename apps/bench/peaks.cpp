// See peaks.h. Loops of intrinsics, compiled for their instruction set function by function.
#include "apps/bench/peaks.h"

#include "apps/bench/timing.h"
#include "src/nn/backend.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace eventide::bench {
namespace {

// Some .2 s of each kind: in its first tens of milliseconds a process may get half of a core.
constexpr int kRounds = 100'000, kRepetitions = 1'000, kCopies = 30;

/// Keeps the compiler from doing a loop once, or never.
template <typename T>
void use(T& value) {
    asm volatile("" : "+m"(value) : : "memory");
}

#if defined(__x86_64__)
// So many sums that none waits for itself, and few enough for the registers.
__attribute__((target("sse4.1"))) float products_sse4(int n) {
    __m128 sums[12];
    for (int i = 0; i < 12; ++i) sums[i] = _mm_set1_ps(float(i));
    const __m128 factor = _mm_set1_ps(0.999F);
    for (int k = 0; k < n; ++k) {
#pragma GCC unroll 12
        for (int i = 0; i < 12; ++i) sums[i] = _mm_add_ps(_mm_mul_ps(sums[i], factor), factor);
    }
    float total = 0;
    for (const __m128& sum : sums) total += sum[0];
    return total;
}
__attribute__((target("avx2,fma"))) float products_avx2(int n) {
    __m256 sums[12];
    for (int i = 0; i < 12; ++i) sums[i] = _mm256_set1_ps(float(i));
    const __m256 factor = _mm256_set1_ps(0.999F);
    for (int k = 0; k < n; ++k) {
#pragma GCC unroll 12
        for (int i = 0; i < 12; ++i) sums[i] = _mm256_fmadd_ps(sums[i], factor, factor);
    }
    float total = 0;
    for (const __m256& sum : sums) total += sum[0];
    return total;
}
__attribute__((target("avx512f"))) float products_avx512(int n) {
    __m512 sums[16];
    for (int i = 0; i < 16; ++i) sums[i] = _mm512_set1_ps(float(i));
    const __m512 factor = _mm512_set1_ps(0.999F);
    for (int k = 0; k < n; ++k) {
#pragma GCC unroll 16
        for (int i = 0; i < 16; ++i) sums[i] = _mm512_fmadd_ps(sums[i], factor, factor);
    }
    float total = 0;
    for (const __m512& sum : sums) total += sum[0];
    return total;
}
__attribute__((target("avx512f,avx512bf16"))) float products_bf16(int n) {
    __m512 sums[16];
    for (int i = 0; i < 16; ++i) sums[i] = _mm512_set1_ps(float(i));
    const __m512bh factor = (__m512bh)_mm512_set1_epi32(0x3c003c00);
    for (int k = 0; k < n; ++k) {
#pragma GCC unroll 16
        for (int i = 0; i < 16; ++i) sums[i] = _mm512_dpbf16_ps(sums[i], factor, factor);
    }
    float total = 0;
    for (const __m512& sum : sums) total += sum[0];
    return total;
}
__attribute__((target("avx512f,avx512vnni"))) float products_int8(int n) {
    __m512i sums[16];
    for (int i = 0; i < 16; ++i) sums[i] = _mm512_set1_epi32(i);
    const __m512i factor = _mm512_set1_epi8(1);
    for (int k = 0; k < n; ++k) {
#pragma GCC unroll 16
        for (int i = 0; i < 16; ++i) sums[i] = _mm512_dpbusd_epi32(sums[i], factor, factor);
    }
    long long total = 0;
    for (const __m512i& sum : sums) total += sum[0];
    return float(total);
}

/// Whole tiles: 16 rows of 64 bytes each.
struct alignas(64) WholeTiles {
    std::uint8_t palette = 1, start = 0, reserved[14] = {};
    std::uint16_t row_bytes[16] = {64, 64, 64, 64, 64, 64, 64};
    std::uint8_t rows[16] = {16, 16, 16, 16, 16, 16, 16};
};

/// Four tiles of sums, two of numbers, one of weights.
__attribute__((target("amx-tile,amx-bf16"))) float products_amx(int n) {
    const WholeTiles shapes;
    _tile_loadconfig(&shapes);  // fills them with zeros
    for (int k = 0; k < n; ++k) {
        _tile_dpbf16ps(0, 4, 6);
        _tile_dpbf16ps(1, 5, 6);
        _tile_dpbf16ps(2, 4, 6);
        _tile_dpbf16ps(3, 5, 6);
    }
    alignas(64) float sums[16][16];
    _tile_stored(0, sums, sizeof(sums[0]));
    _tile_release();
    return sums[0][0];
}

/// `products` per round, in 1e9 operations a second: of the best repetition, as what a neighbour on
/// the same core takes away is no limit of this one.
double rate_of(float (*loop)(int), double products) {
    const Timing timing = timed(kRepetitions, [&](int) {
        int rounds = kRounds;
        use(rounds);
        float total = loop(rounds);
        use(total);
    });
    return 2 * products * kRounds / (1e6 * timing.cpu_ms.least);
}
#endif

double copy_rate() {
    constexpr std::size_t kBytes = std::size_t{64} << 20;
    std::vector<char> from(kBytes, 1), to(kBytes, 2);
    const Timing timing = timed(kCopies, [&](int) {
        std::memcpy(to.data(), from.data(), kBytes);
        use(to[0]);
    });
    return 2 * double(kBytes) / (1e6 * timing.cpu_ms.least);
}

}  // namespace

double Peaks::f32() const {
    return std::max({f32_sse4, f32_avx2, f32_avx512});
}

Peaks measure_peaks(Instructions most) {
    Peaks peaks;
#if defined(__x86_64__)
    if (__builtin_cpu_supports("sse4.1") != 0) peaks.f32_sse4 = rate_of(products_sse4, 12 * 4);
    if (most <= Instructions::avx2 && __builtin_cpu_supports("avx2") != 0 &&
        __builtin_cpu_supports("fma") != 0)
        peaks.f32_avx2 = rate_of(products_avx2, 12 * 8);
    if (most <= Instructions::avx512) {
        if (__builtin_cpu_supports("avx512f") != 0)
            peaks.f32_avx512 = rate_of(products_avx512, 16 * 16);
        if (__builtin_cpu_supports("avx512bf16") != 0) peaks.bf16 = rate_of(products_bf16, 16 * 32);
        if (__builtin_cpu_supports("avx512vnni") != 0) peaks.int8 = rate_of(products_int8, 16 * 64);
    }
    if (amx_kernels(most) != nullptr) peaks.bf16_amx = rate_of(products_amx, 4 * 16 * 16 * 32);
#else
    (void)most;
#endif
    peaks.copy_gb_s = copy_rate();
    return peaks;
}

}  // namespace eventide::bench
