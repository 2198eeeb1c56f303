// See bf16_render.h. Pixels go through in pairs of runs of 16, and leave the core's own cache at
// the end alone:
//
//     sums of layer 1, bf16   + base + dx slope, relu   -> A: 16 pixels x up to 32 numbers, twice
//     A x B (hidden weights)                            -> C: 16 pixels x 2 x 16 sums, twice
//     relu(C) . the last layer's two rows               -> 16 mu, 16 log sigma, twice
#include "src/kernels/bf16_render.h"

#if defined(__x86_64__)

#include "src/kernels/bf16_lanes.h"

#include <algorithm>

namespace eventide::amx {
namespace {

constexpr int kMaxNumbers = 32;

/// What 32 pixels pass through, 6 KiB:
///
///     numbers    rows 0 to 15: A of run 0, rows 16 to 31: A of run 1; a row is one pixel's 32
///                numbers, 64 bytes, with zeros past the layer's width
///     sums       [0] run 0, outputs 0 to 15     [1] run 0, outputs 16 to 31
///                [2] run 1, outputs 0 to 15     [3] run 1, outputs 16 to 31
struct Room {
    alignas(64) std::uint16_t numbers[kBoth][kMaxNumbers] = {};
    alignas(64) float sums[4][kRun][kTileOutputs];  // of 16 pixels: outputs 0-15, 16-31
};

/// relu(sums + base + dx slope) of `count` pixels as bf16, one row of `numbers` each. kSame: all
/// have the same dx, which is in base already.
template <bool kSame>
EVENTIDE_AMX_INLINE void offset_pixels(const OffsetRows& r, const Offsets& offsets, int first,
                                       int count, Room& room) {
    const __mmask16 of_pixel = first_lanes(r.width / 2);
    for (int p = 0; p < count; ++p) {
        const auto* sums = static_cast<const std::uint16_t*>(r.sums) +
                           std::ptrdiff_t(r.column[first + p]) * r.width;
        __builtin_prefetch(sums + 2 * r.ahead, 0, 2);
        const __m512i units = _mm512_maskz_loadu_epi32(of_pixel, sums);
        __m512 even = offsets.base[0], odd = offsets.base[1];
        if (!kSame) {
            const __m512 dx = _mm512_set1_ps(r.dx[first + p]);
            even = offsets.at(0, dx);
            odd = offsets.at(1, dx);
        }
        _mm512_store_si512(room.numbers[p], units_plus(units, even, odd));
    }
}

/// The two rows of the last layer.
struct LastLayer {
    __m512 first_low, first_high, second_low, second_high;
    EVENTIDE_AMX_INLINE explicit LastLayer(const HiddenRows& r) {
        const __mmask16 high = first_lanes(r.outputs - kTileOutputs);
        const float* second = r.last_weight + r.outputs;
        first_low = _mm512_loadu_ps(r.last_weight);
        first_high = _mm512_maskz_loadu_ps(high, r.last_weight + kTileOutputs);
        second_low = _mm512_loadu_ps(second);
        second_high = _mm512_maskz_loadu_ps(high, second + kTileOutputs);
    }
};
/// relu(sums) times its rows, of a pixel's sums in two vectors.
EVENTIDE_AMX_INLINE PairOfSums products(const LastLayer& last, __m512 low, __m512 high) {
    const __m512 a = _mm512_max_ps(low, _mm512_setzero_ps()),
                 b = _mm512_max_ps(high, _mm512_setzero_ps());
    return {_mm512_fmadd_ps(a, last.first_low, _mm512_mul_ps(b, last.first_high)),
            _mm512_fmadd_ps(a, last.second_low, _mm512_mul_ps(b, last.second_high))};
}

/// sums = bias + numbers x hidden weights:
///
///                           B in 6: outputs 0 to 15    B in 7: outputs 16 to 31
///     A in 4: run 0         C 0                        C 1
///     A in 5: run 1         C 2                        C 3
EVENTIDE_AMX_INLINE void multiply_tiles(const HiddenRows& r, Room& room) {
    constexpr std::ptrdiff_t kRow = sizeof(room.numbers[0]), kSums = sizeof(room.sums[0][0]);
    load_tile<0>(r.bias, 0);
    load_tile<1>(r.bias + kTileOutputs, 0);
    load_tile<2>(r.bias, 0);
    load_tile<3>(r.bias + kTileOutputs, 0);
    load_tile<4>(room.numbers[0], kRow);
    _tile_dpbf16ps(0, 4, 6);
    _tile_dpbf16ps(1, 4, 7);
    load_tile<5>(room.numbers[kRun], kRow);
    _tile_dpbf16ps(2, 5, 6);
    _tile_dpbf16ps(3, 5, 7);
    store_tile<0>(room.sums[0], kSums);
    store_tile<1>(room.sums[1], kSums);
    store_tile<2>(room.sums[2], kSums);
    store_tile<3>(room.sums[3], kSums);
}

/// Both runs' outputs from their tiles of sums.
EVENTIDE_AMX void outputs_of_tiles(const HiddenRows& r, const LastLayer& last, int first, int count,
                                   Room& room) {
    multiply_tiles(r, room);
    for (int run = 0; run * kRun < count; ++run) {
        const auto of_pixel = [&](int p) EVENTIDE_AMX {
            return products(last, _mm512_load_ps(room.sums[2 * run][p]),
                            _mm512_load_ps(room.sums[2 * run + 1][p]));
        };
        put_outputs(r, sums_of<kRun>(of_pixel, 0), first + run * kRun, count - run * kRun);
    }
}

/// Eight pixels by vectors: 2 x 16 sums of each stay in registers until they are products of the
/// last layer. 8 x 2 sums, 2 weights and a pair: 19 of 32 registers.
EVENTIDE_AMX_INLINE PairOfSums multiply_eight(const HiddenRows& r, const LastLayer& last,
                                              const std::uint16_t (*numbers)[kMaxNumbers]) {
    constexpr int kPixels = kRun / 2;
    const auto* weight = static_cast<const std::uint32_t*>(r.weight);
    __m512 low[kPixels], high[kPixels];
    for (int p = 0; p < kPixels; ++p) {
        low[p] = _mm512_loadu_ps(r.bias);
        high[p] = _mm512_loadu_ps(r.bias + kTileOutputs);
    }
    for (int k = 0; k < r.offset.width / 2; ++k) {
        const auto* at = weight + std::ptrdiff_t(k) * 2 * kTileOutputs;
        const auto weight_low = (__m512bh)_mm512_loadu_si512(at),
                   weight_high = (__m512bh)_mm512_loadu_si512(at + kTileOutputs);
#pragma GCC unroll 8
        for (int p = 0; p < kPixels; ++p) {
            const auto pair = (__m512bh)_mm512_set1_epi32(unit_at(numbers[p], k));
            low[p] = _mm512_dpbf16_ps(low[p], pair, weight_low);
            high[p] = _mm512_dpbf16_ps(high[p], pair, weight_high);
        }
    }
    return sums_of<kPixels>([&](int p) EVENTIDE_AMX { return products(last, low[p], high[p]); }, 0);
}
EVENTIDE_AMX void outputs_by_vectors(const HiddenRows& r, const LastLayer& last, int first,
                                     int count, const Room& room) {
    const auto eight = [&](int p)
                           EVENTIDE_AMX { return multiply_eight(r, last, room.numbers + p); };
    put_by_eights(r, eight, first, count);
}

/// The hidden layer's weights, which stay in tiles 6 and 7 for all pixels: one product takes the
/// whole width, of at most 16 pairs.
EVENTIDE_AMX void start_tiles(const HiddenRows& r) {
    const TileShapes shapes{kRun, r.offset.width / 2};
    _tile_loadconfig(&shapes);
    constexpr std::ptrdiff_t kWeightStep = 2 * kTileOutputs * sizeof(std::uint32_t);
    load_tile<6>(r.weight, kWeightStep);
    load_tile<7>(static_cast<const std::uint32_t*>(r.weight) + kTileOutputs, kWeightStep);
}

template <bool kTiles>
EVENTIDE_AMX bool run_rows(const HiddenRows& r) {
    const OffsetRows& offset = r.offset;
    if (r.outputs <= kTileOutputs) return narrow_rows(r, kTiles);
    // One row of A holds a pixel's numbers, in pairs; two tiles of sums its 17 to 32 outputs.
    if (offset.width % 2 != 0 || offset.width > kMaxNumbers || r.outputs > 2 * kTileOutputs)
        return false;
    if (kTiles) start_tiles(r);
    Offsets offsets{offset, false};
    const bool is_same = offset.pixels > 0 && all_same(offset.dx, offset.pixels);
    if (is_same) offsets.move(offset.dx[0]);
    const LastLayer last{r};
    Room room;
    for (int first = 0; first < offset.pixels; first += kBoth) {
        // Rows past the last pixel hold what was there before; their sums are not stored.
        const int count = std::min(kBoth, offset.pixels - first);
        is_same ? offset_pixels<true>(offset, offsets, first, count, room)
                : offset_pixels<false>(offset, offsets, first, count, room);
        kTiles ? outputs_of_tiles(r, last, first, count, room)
               : outputs_by_vectors(r, last, first, count, room);
    }
    if (kTiles) _tile_release();
    return true;
}

}  // namespace
}  // namespace eventide::amx

namespace eventide {

bool avx512_bf16::hidden_rows(const HiddenRows& rows) {
    return amx::run_rows<false>(rows);
}
bool amx::hidden_rows(const HiddenRows& rows) {
    return amx::run_rows<true>(rows);
}

}  // namespace eventide

#endif
