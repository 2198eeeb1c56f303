// What the processor's units can do at most in float32, for benchmarks to be held against.
#pragma once

#include "src/kernels/vector_kernels.h"

#include <benchmark/benchmark.h>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace eventide::bench {

#if defined(__x86_64__)
/// Independent fused multiply-adds on registers: what no kernel can pass.
__attribute__((target("avx512f"))) inline float peak_avx512(int n) {
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
__attribute__((target("avx2,fma"))) inline float peak_avx2(int n) {
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
inline void peak(benchmark::State& state, bool wide) {
    constexpr int kRounds = 100'000;
    for (auto _ : state) {
        int rounds = kRounds;
        benchmark::DoNotOptimize(rounds);  // or the loop would be done once
        benchmark::DoNotOptimize(wide ? peak_avx512(rounds) : peak_avx2(rounds));
    }
    state.counters["GFLOP/s"] = benchmark::Counter(2e-9 * kRounds * (wide ? 16.0 * 16 : 12.0 * 8),
                                                   benchmark::Counter::kIsIterationInvariantRate);
}
#endif

/// Does nothing on other processors.
inline void add_peaks() {
#if defined(__x86_64__)
    benchmark::RegisterBenchmark("peak/avx2", peak, false)
        ->Unit(benchmark::kMillisecond)
        ->MinTime(0.3);
    if (!kernels_limited() && __builtin_cpu_supports("avx512f") != 0)
        benchmark::RegisterBenchmark("peak/avx512", peak, true)
            ->Unit(benchmark::kMillisecond)
            ->MinTime(0.3);
#endif
}

}  // namespace eventide::bench
