// The loops of the fused steps, over channels-last memory; compiled for several instruction sets,
// one of which is chosen as the program starts.
#pragma once

#include <cstdint>

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define EVENTIDE_CLONES \
    __attribute__((target_clones("arch=skylake-avx512", "arch=haswell", "default")))
#else
#define EVENTIDE_CLONES
#endif

namespace eventide::fused {

struct MapSize {
    std::int64_t pixels = 0, channels = 0;
    std::int64_t gates = 0;  ///< of a pixel: C update gates, or these and C reset gates
};

/// out = r h; gates hold 2C channels per pixel.
template <typename T, typename W>
EVENTIDE_CLONES void reset_forward(MapSize size, const T* gates, const W* h, T* out) {
    const std::int64_t C = size.channels;
    for (std::int64_t p = 0; p < size.pixels; ++p)
        for (std::int64_t c = 0; c < C; ++c)
            out[p * C + c] = T(W(gates[p * 2 * C + C + c]) * h[p * C + c]);
}

template <typename T, typename W>
EVENTIDE_CLONES void reset_backward(MapSize size, const T* gates, const W* h, const T* g,
                                    T* g_gates, W* g_h) {
    const std::int64_t C = size.channels;
    for (std::int64_t p = 0; p < size.pixels; ++p)
        for (std::int64_t c = 0; c < C; ++c) {
            const W v = W(g[p * C + c]);
            g_gates[p * 2 * C + c] = T(0);
            g_gates[p * 2 * C + C + c] = T(v * h[p * C + c]);
            g_h[p * C + c] = v * W(gates[p * 2 * C + C + c]);
        }
}

/// mask == nullptr: 1 everywhere.
template <typename T, typename W>
EVENTIDE_CLONES void update_forward(MapSize size, const T* gates, const T* candidate, const W* h,
                                    const W* mask, W* out) {
    const std::int64_t C = size.channels, G = size.gates;
    for (std::int64_t p = 0; p < size.pixels; ++p) {
        const W m = mask != nullptr ? mask[p] : W(1);
        for (std::int64_t c = 0; c < C; ++c) {
            const W old = h[p * C + c];
            out[p * C + c] = old + m * W(gates[p * G + c]) * (W(candidate[p * C + c]) - old);
        }
    }
}

template <typename T, typename W>
EVENTIDE_CLONES void update_backward(MapSize size, const T* gates, const T* candidate, const W* h,
                                     const W* mask, const W* g, T* g_gates, T* g_candidate,
                                     W* g_h) {
    const std::int64_t C = size.channels, G = size.gates;
    for (std::int64_t p = 0; p < size.pixels; ++p) {
        const W m = mask != nullptr ? mask[p] : W(1);
        for (std::int64_t c = C; c < G; ++c) g_gates[p * G + c] = T(0);
        for (std::int64_t c = 0; c < C; ++c) {
            const W v = g[p * C + c], through = v * m, u = W(gates[p * G + c]);
            g_gates[p * G + c] = T(through * (W(candidate[p * C + c]) - h[p * C + c]));
            g_candidate[p * C + c] = T(through * u);
            g_h[p * C + c] = v - through * u;
        }
    }
}

/// One pixel of up2: the mean of its up to four sources (the same ones twice where fewer).
template <typename T, typename W>
EVENTIDE_CLONES void mean4(std::int64_t channels, const T* a, const T* b, const T* c, const T* d,
                           T* out) {
    for (std::int64_t k = 0; k < channels; ++k)
        out[k] = T((W(a[k]) + W(b[k]) + W(c[k]) + W(d[k])) * W(.25));
}

template <typename T, typename W>
EVENTIDE_CLONES void add_quarter(std::int64_t channels, const T* g, W* sum) {
    for (std::int64_t k = 0; k < channels; ++k) sum[k] += W(g[k]) * W(.25);
}

/// One point of the renderer's first layer. `row` is dt o_0 + dy o_2, the same along a row.
template <typename T, typename W>
EVENTIDE_CLONES void offset_point(std::int64_t channels, const T* first, const W* row, const W* ox,
                                  W dx, T* out) {
    for (std::int64_t k = 0; k < channels; ++k) {
        const W v = W(first[k]) + row[k] + dx * ox[k];
        out[k] = T(v > W(0) ? v : W(0));
    }
}

template <typename T, typename W>
EVENTIDE_CLONES void offset_point_backward(std::int64_t channels, const T* out, const T* g, W dx,
                                           W* g_first, W* sum, W* sum_x) {
    for (std::int64_t k = 0; k < channels; ++k) {
        const W v = W(out[k]) > W(0) ? W(g[k]) : W(0);
        g_first[k] += v;
        sum[k] += v;
        sum_x[k] += dx * v;
    }
}

}  // namespace eventide::fused
