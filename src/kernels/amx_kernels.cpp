// See bf16_kernels.h, by AMX: products of whole tiles, 16 pixels x 16 outputs x up to 32 channels.
//
//     tile register            rows             a row (64 bytes at most)
//     A: numbers               16 pixels        pairs of bf16 numbers, as they lie in memory
//     B: weights               pairs            16 outputs x 2, in the order of packed_size()
//     C: sums                  16 pixels        16 outputs in float32
//
// A convolution's stretch is read where it lies: the rows of A are `step` apart and overlap. Four C
// stay in registers over all stretches: four runs of pixels x one vector of outputs, or two x two.
#include "src/kernels/bf16_kernels.h"

#if defined(__x86_64__) && defined(__linux__)

#include "src/kernels/amx_tiles.h"

#include <cpuid.h>
#include <sys/syscall.h>
#include <unistd.h>
#include "src/kernels/bf16_render.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace eventide {
namespace {

using namespace amx;

constexpr int kSumTiles = 4;

/// Pairs of a stretch that go into one product: the same for all of a layer.
/// At most 16, and a divisor of every stretch's length:
///
///     channels of a 3x3 layer    8     16        21        24        64
///     pairs of a stretch         12    24        33        36        96
///     pairs of a product         12    12        11        12        16
///     products of a stretch      1     2         3         3         6
int pairs_of(const DotArea& r) {
    int common = 0;
    for (int s = 0; s < r.count; ++s) common = std::gcd(common, r.stretches[s].length);
    int pairs = std::min(common, 16);
    while (pairs > 0 && common % pairs != 0) --pairs;
    return pairs;
}

/// A run of so many pixels of a row begins here.
struct Run {
    int y, x;
};

struct Work {
    const DotArea& area;
    int pixels, pairs;  // of a run, of a product
};

/// C += A B
template <int kSum, int kNumbers, int kWeights>
EVENTIDE_AMX_INLINE void add_products() {
    if constexpr (kSum == 0 && kNumbers == 4) _tile_dpbf16ps(0, 4, 6);
    if constexpr (kSum == 1 && kNumbers == 4) _tile_dpbf16ps(1, 4, 7);
    if constexpr (kSum == 1 && kNumbers == 5) _tile_dpbf16ps(1, 5, 6);
    if constexpr (kSum == 2 && kNumbers == 4) _tile_dpbf16ps(2, 4, 6);
    if constexpr (kSum == 2 && kNumbers == 5) _tile_dpbf16ps(2, 5, 6);
    if constexpr (kSum == 3 && kNumbers == 5 && kWeights == 6) _tile_dpbf16ps(3, 5, 6);
    if constexpr (kSum == 3 && kNumbers == 5 && kWeights == 7) _tile_dpbf16ps(3, 5, 7);
}

/// bf16 numbers of two vectors of sums, one behind the other.
EVENTIDE_AMX_INLINE void put_both(const float* low, const float* high, __m512 floor, void* to) {
    _mm512_storeu_si512(to,
                        (__m512i)_mm512_cvtne2ps_pbh(_mm512_max_ps(_mm512_load_ps(high), floor),
                                                     _mm512_max_ps(_mm512_load_ps(low), floor)));
}
/// Stores a tile of sums where its pixels belong.
template <int kTile>
EVENTIDE_AMX_INLINE void put(const Work& work, Run run, int first) {
    const DotArea& r = work.area;
    const std::ptrdiff_t at = run.y * r.out_pitch + run.x * r.out_step;
    if (!r.to_bf16 && !r.relu && r.outputs - first >= kTileOutputs) {
        store_tile<kTile>(static_cast<float*>(r.out) + at + first,
                          r.out_step * std::ptrdiff_t{sizeof(float)});
        return;
    }
    alignas(64) float sums[kTileRows * kTileOutputs];
    store_tile<kTile>(sums, kTileOutputs * sizeof(float));
    const __m512 floor = _mm512_set1_ps(r.relu ? 0.0F : -std::numeric_limits<float>::infinity());
    // An odd number of outputs as bf16: the sum beside the last is of zeros alone, as it should be.
    const int stored = r.to_bf16 ? (r.outputs + 1) / 2 * 2 : r.outputs;
    const auto mask =
        __mmask16(stored - first >= kTileOutputs ? 0xffffU : (1U << unsigned(stored - first)) - 1U);
    if (r.to_bf16) {
        auto* to = static_cast<std::uint16_t*>(r.out) + 2 * at + first;
        int p = 0;
        // Pixels of 16 outputs lie one behind the other: two of them at once.
        if (r.outputs == kTileOutputs && 2 * r.out_step == kTileOutputs)
            for (; p + 2 <= work.pixels; p += 2, to += 2 * kTileOutputs)
                put_both(sums + p * kTileOutputs, sums + (p + 1) * kTileOutputs, floor, to);
        for (; p < work.pixels; ++p, to += 2 * r.out_step)
            _mm256_mask_storeu_epi16(to, mask,
                                     (__m256i)_mm512_cvtneps_pbh(_mm512_max_ps(
                                         _mm512_load_ps(sums + p * kTileOutputs), floor)));
    } else {
        float* to = static_cast<float*>(r.out) + at + first;
        for (int p = 0; p < work.pixels; ++p, to += r.out_step)
            _mm512_mask_storeu_ps(to, mask,
                                  _mm512_max_ps(_mm512_load_ps(sums + p * kTileOutputs), floor));
    }
}

/// put() of two tiles with the sums of the same pixels: a pixel's 32 outputs are converted at once
/// where there are so many.
template <int kLow, int kHigh>
EVENTIDE_AMX_INLINE void put_two(const Work& work, Run run, int first) {
    const DotArea& r = work.area;
    if (!r.to_bf16 || r.outputs - first < 2 * kTileOutputs) {
        put<kLow>(work, run, first);
        put<kHigh>(work, run, first + kTileOutputs);
        return;
    }
    alignas(64) float sums[2][kTileRows * kTileOutputs];
    store_tile<kLow>(sums[0], kTileOutputs * sizeof(float));
    store_tile<kHigh>(sums[1], kTileOutputs * sizeof(float));
    const __m512 floor = _mm512_set1_ps(r.relu ? 0.0F : -std::numeric_limits<float>::infinity());
    auto* to =
        static_cast<std::uint16_t*>(r.out) + 2 * (run.y * r.out_pitch + run.x * r.out_step) + first;
    const std::ptrdiff_t step = 2 * r.out_step;
    for (int p = 0; p < work.pixels; ++p, to += step)
        put_both(sums[0] + p * kTileOutputs, sums[1] + p * kTileOutputs, floor, to);
}

/// kRuns runs of pixels x one or two vectors of outputs from `first` on.
/// C += A B in the tile registers:
///
///     two vectors of outputs (kTwo)             one vector
///                  B in 6    B in 7                          B in 6
///     A in 4       C 0       C 1                A in 4       C 0        runs 0 and 2 take turns
///     A in 5       C 2       C 3                A in 5       C 1        in 4, runs 1 and 3 in 5
///                                               A in 4       C 2
///                                               A in 5       C 3
///
/// Rows of A overlap in memory. Of a 3x3 layer of 16 channels, 8 pairs a pixel, products of 12:
///
///     stretch    pixel 0: 0 .. 7    pixel 1: 8 .. 15    pixel 2: 16 .. 23    pixel 3: 24 .. 31
///     k = 0      row 0: 0 .. 11     row 1: 8 .. 19      row 2: 16 .. 27      ...
///     k = 12     row 0: 12 .. 23    row 1: 20 .. 31     row 2: 28 .. 39      ...
///
/// B is 12 rows of the packed weights, one for each pair, 16 units of the 16 or 32 that lie there.
template <int kRuns, bool kTwo>
EVENTIDE_AMX void dot_runs(const Work& work, const Run* runs, const std::uint32_t* weight,
                           int first) {
    constexpr int kWidth = (kTwo ? 2 : 1) * kTileOutputs;
    constexpr std::ptrdiff_t kWeightStep = kWidth * sizeof(std::uint32_t);
    const DotArea& r = work.area;
    // A step of 0 loads the same row, the bias, into all.
    load_tile<0>(r.bias + first, 0);
    if constexpr (kTwo) load_tile<1>(r.bias + first + kTileOutputs, 0);
    if constexpr (kTwo && kRuns > 1) load_tile<2>(r.bias + first, 0);
    if constexpr (kTwo && kRuns > 1) load_tile<3>(r.bias + first + kTileOutputs, 0);
    if constexpr (!kTwo && kRuns > 1) load_tile<1>(r.bias + first, 0);
    if constexpr (!kTwo && kRuns > 2) load_tile<2>(r.bias + first, 0);
    if constexpr (!kTwo && kRuns > 3) load_tile<3>(r.bias + first, 0);
    for (int s = 0; s < r.count; ++s) {
        const Stretch& stretch = r.stretches[s];
        const std::ptrdiff_t step = stretch.step * std::ptrdiff_t{sizeof(std::uint32_t)};
        const std::uint32_t* in[kRuns];
        for (int i = 0; i < kRuns; ++i)
            in[i] = static_cast<const std::uint32_t*>(stretch.in) + runs[i].y * stretch.pitch +
                    runs[i].x * stretch.step;
        for (int k = 0; k < stretch.length; k += work.pairs, weight += work.pairs * kWidth) {
            load_tile<6>(weight, kWeightStep);
            load_tile<4>(in[0] + k, step);
            add_products<0, 4, 6>();
            if constexpr (kTwo) {
                load_tile<7>(weight + kTileOutputs, kWeightStep);
                add_products<1, 4, 7>();
                if constexpr (kRuns > 1) {
                    load_tile<5>(in[1] + k, step);
                    add_products<2, 5, 6>();
                    add_products<3, 5, 7>();
                }
            } else {
                if constexpr (kRuns > 1) load_tile<5>(in[1] + k, step), add_products<1, 5, 6>();
                if constexpr (kRuns > 2) load_tile<4>(in[2] + k, step), add_products<2, 4, 6>();
                if constexpr (kRuns > 3) load_tile<5>(in[3] + k, step), add_products<3, 5, 6>();
            }
        }
    }
    if constexpr (kTwo) put_two<0, 1>(work, runs[0], first);
    if constexpr (kTwo && kRuns > 1) put_two<2, 3>(work, runs[1], first);
    if constexpr (!kTwo) put<0>(work, runs[0], first);
    if constexpr (!kTwo && kRuns > 1) put<1>(work, runs[1], first);
    if constexpr (!kTwo && kRuns > 2) put<2>(work, runs[2], first);
    if constexpr (!kTwo && kRuns > 3) put<3>(work, runs[3], first);
}

/// All pixels x one or two vectors of outputs. The rows' last runs overlap those before, so that
/// all have the same length.
template <bool kTwo>
EVENTIDE_AMX void dot_outputs(const Work& work, const std::uint32_t* weight, int first) {
    constexpr int kMax = kTwo ? kSumTiles / 2 : kSumTiles;
    const DotArea& r = work.area;
    Run runs[kMax];
    int n = 0;
    for (int y = 0; y < r.height; ++y)
        for (int x = 0; x < r.width; x += work.pixels) {
            // Of 17 pixels in runs of 9: from 0 and from 8; pixel 8 is written twice, with the same
            // bits.
            runs[n++] = {y, std::min(x, r.width - work.pixels)};
            if (n < kMax) continue;
            dot_runs<kMax, kTwo>(work, runs, weight, first);
            n = 0;
        }
    if (n == 1) dot_runs<1, kTwo>(work, runs, weight, first);
    if constexpr (!kTwo) {
        if (n == 2) dot_runs<2, kTwo>(work, runs, weight, first);
        if (n == 3) dot_runs<3, kTwo>(work, runs, weight, first);
    }
}

EVENTIDE_AMX void dot_area(const DotArea& r) {
    // Products of fewer pairs, and of half vectors of outputs, are not worth a tile.
    constexpr int kLeastPairs = 4;
    const int pairs = pairs_of(r);
    if (pairs < kLeastPairs || bf16_lanes(r.outputs) != kTileOutputs || r.height * r.width == 0) {
        avx512_bf16::bf16_kernels().dot_area(r);
        return;
    }
    // As few runs as 16 rows allow, of one length, since tiles have one shape for all of the area.
    const int parts = (r.width + kTileRows - 1) / kTileRows;
    const Work work{r, (r.width + parts - 1) / parts, pairs};
    const TileShapes shapes{work.pixels, pairs};
    _tile_loadconfig(&shapes);
    std::ptrdiff_t length = 0;
    for (int s = 0; s < r.count; ++s) length += r.stretches[s].length;
    const auto* weight = static_cast<const std::uint32_t*>(r.weight);
    for (int first = 0; first < r.outputs;) {
        const bool is_two = r.outputs - first > kTileOutputs;
        is_two ? dot_outputs<true>(work, weight, first) : dot_outputs<false>(work, weight, first);
        const int width = (is_two ? 2 : 1) * kTileOutputs;
        weight += length * width;
        first += width;
    }
    _tile_release();
}

bool processor_has_amx() {
    unsigned a = 0, b = 0, c = 0, d = 0;
    constexpr unsigned kBf16 = 1U << 22, kTile = 1U << 24;
    return __get_cpuid_count(7, 0, &a, &b, &c, &d) != 0 && (d & kBf16) != 0 && (d & kTile) != 0;
}

/// Whether the processor has AMX, and Linux lets this process use its registers (asked once).
bool amx_there() {
    constexpr long kRequestPermission = 0x1023, kTileData = 18;  // ARCH_REQ_XCOMP_PERM, XTILEDATA
    static const bool kThere = avx512_bf16::there() && processor_has_amx() &&
                               ::syscall(SYS_arch_prctl, kRequestPermission, kTileData) == 0;
    return kThere;
}

}  // namespace

const Bf16Kernels* amx_kernels(Instructions most) {
    if (most != Instructions::best || !amx_there()) return nullptr;
    const Bf16Kernels& vectors = avx512_bf16::bf16_kernels();
    static const Bf16Kernels kKernels{.name = "AMX",
                                      .by_lines = true,
                                      .dot_area = dot_area,
                                      .pixels_to_bf16 = vectors.pixels_to_bf16,
                                      .row_to_bf16 = vectors.row_to_bf16,
                                      .compress_row = vectors.compress_row,
                                      .keep_row = vectors.keep_row,
                                      .update_row = vectors.update_row,
                                      .double_row = vectors.double_row,
                                      .offset_rows = vectors.offset_rows,
                                      .hidden_rows = amx::hidden_rows};
    return &kKernels;
}

}  // namespace eventide

#else

namespace eventide {

const Bf16Kernels* amx_kernels(Instructions) {
    return nullptr;
}

}  // namespace eventide

#endif
