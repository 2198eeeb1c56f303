// The same as bf16_render.cpp for layers of up to 16 numbers, of which a vector takes two pixels:
//
//     sums of layer 1, bf16   + base + dx slope, relu   -> A: 16 pixels x 16 numbers, twice
//     A x B (hidden weights)                            -> C: 16 pixels x 16 sums, twice
//     relu(C) . the last layer's two rows               -> 16 mu, 16 log sigma, twice
#include "src/kernels/bf16_render.h"

#if defined(__x86_64__)

#include "src/kernels/bf16_lanes.h"

#include <algorithm>

namespace eventide::amx {
namespace {

constexpr int kMaxNumbers = 16;

/// What 32 pixels pass through, 3 KiB. A row of numbers is one pixel's, 32 bytes, with zeros past
/// the layer's width.
struct Room {
    alignas(64) std::uint16_t numbers[kBoth][kMaxNumbers] = {};
    alignas(64) float sums[2][kRun][kTileOutputs];
};

EVENTIDE_AMX_INLINE __m512i both(__m256i first, __m256i second) {
    return _mm512_inserti64x4(_mm512_castsi256_si512(first), second, 1);
}

/// relu(sums + base + dx slope) of `count` pixels as bf16. `is_same`: all have the same dx, which
/// is in base already.
EVENTIDE_AMX_INLINE void offset_pixels(const OffsetRows& r, const Offsets& offsets, bool is_same,
                                       int first, int count, Room& room) {
    const auto units = __mmask8(first_lanes(r.width / 2));
    const auto* sums = static_cast<const std::uint16_t*>(r.sums);
    __m512 even = offsets.base[0], odd = offsets.base[1];
    for (int p = 0; p < count; p += 2) {
        const int a = first + p, b = first + std::min(p + 1, count - 1);
        const std::uint16_t *of_a = sums + std::ptrdiff_t(r.column[a]) * r.width,
                            *of_b = sums + std::ptrdiff_t(r.column[b]) * r.width;
        __builtin_prefetch(of_a + 2 * r.ahead, 0, 2);
        if (!is_same) {
            const __m512 dx =
                (__m512)both((__m256i)_mm256_set1_ps(r.dx[a]), (__m256i)_mm256_set1_ps(r.dx[b]));
            even = offsets.at(0, dx);
            odd = offsets.at(1, dx);
        }
        _mm512_store_si512(room.numbers[p], units_plus(both(_mm256_maskz_loadu_epi32(units, of_a),
                                                            _mm256_maskz_loadu_epi32(units, of_b)),
                                                       even, odd));
    }
}

/// sums = bias + numbers x hidden weights: A in 4 and 5, B in 6, C in 0 and 2.
EVENTIDE_AMX_INLINE void multiply_tiles(const HiddenRows& r, Room& room) {
    constexpr std::ptrdiff_t kRow = sizeof(room.numbers[0]), kSums = sizeof(room.sums[0][0]);
    load_tile<0>(r.bias, 0);
    load_tile<2>(r.bias, 0);
    load_tile<4>(room.numbers[0], kRow);
    _tile_dpbf16ps(0, 4, 6);
    load_tile<5>(room.numbers[kRun], kRow);
    _tile_dpbf16ps(2, 5, 6);
    store_tile<0>(room.sums[0], kSums);
    store_tile<2>(room.sums[1], kSums);
}

/// The two rows of the last layer.
struct LastLayer {
    __m512 first, second;
};
/// relu(sums) times its rows, of a pixel's sums.
EVENTIDE_AMX_INLINE PairOfSums products(const LastLayer& last, __m512 sums) {
    const __m512 in = _mm512_max_ps(sums, _mm512_setzero_ps());
    return {_mm512_mul_ps(in, last.first), _mm512_mul_ps(in, last.second)};
}

/// As in bf16_render.cpp.
EVENTIDE_AMX void outputs_of_tiles(const HiddenRows& r, const LastLayer& last, int first, int count,
                                   Room& room) {
    multiply_tiles(r, room);
    for (int run = 0; run * kRun < count; ++run) {
        const auto of_pixel = [&](int p) EVENTIDE_AMX {
            return products(last, _mm512_load_ps(room.sums[run][p]));
        };
        put_outputs(r, sums_of<kRun>(of_pixel, 0), first + run * kRun, count - run * kRun);
    }
}
EVENTIDE_AMX_INLINE PairOfSums multiply_eight(const HiddenRows& r, const LastLayer& last,
                                              const std::uint16_t (*numbers)[kMaxNumbers]) {
    constexpr int kPixels = kRun / 2;
    const auto* weight = static_cast<const std::uint32_t*>(r.weight);
    __m512 sums[kPixels];
    for (__m512& sum : sums) sum = _mm512_loadu_ps(r.bias);
    for (int k = 0; k < r.offset.width / 2; ++k) {
        const auto of_pair = (__m512bh)_mm512_loadu_si512(weight + k * kTileOutputs);
#pragma GCC unroll 8
        for (int p = 0; p < kPixels; ++p) {
            const auto pair = (__m512bh)_mm512_set1_epi32(unit_at(numbers[p], k));
            sums[p] = _mm512_dpbf16_ps(sums[p], pair, of_pair);
        }
    }
    return sums_of<kPixels>([&](int p) EVENTIDE_AMX { return products(last, sums[p]); }, 0);
}
EVENTIDE_AMX void outputs_by_vectors(const HiddenRows& r, const LastLayer& last, int first,
                                     int count, const Room& room) {
    const auto eight = [&](int p)
                           EVENTIDE_AMX { return multiply_eight(r, last, room.numbers + p); };
    put_by_eights(r, eight, first, count);
}

EVENTIDE_AMX void start_tiles(const HiddenRows& r) {
    const TileShapes shapes{kRun, r.offset.width / 2};
    _tile_loadconfig(&shapes);
    load_tile<6>(r.weight, kTileOutputs * sizeof(std::uint32_t));
}

template <bool kTiles>
EVENTIDE_AMX void run_rows(const HiddenRows& r) {
    const OffsetRows& offset = r.offset;
    if (kTiles) start_tiles(r);
    Offsets offsets{offset, true};
    const bool is_same = all_same(offset.dx, offset.pixels);
    if (is_same) offsets.move(offset.dx[0]);
    const __mmask16 outputs = first_lanes(r.outputs);
    const LastLayer last{_mm512_maskz_loadu_ps(outputs, r.last_weight),
                         _mm512_maskz_loadu_ps(outputs, r.last_weight + r.outputs)};
    Room room;
    for (int first = 0; first < offset.pixels; first += kBoth) {
        // Rows past the last pixel hold what was there before; their sums are not stored.
        const int count = std::min(kBoth, offset.pixels - first);
        offset_pixels(offset, offsets, is_same, first, count, room);
        kTiles ? outputs_of_tiles(r, last, first, count, room)
               : outputs_by_vectors(r, last, first, count, room);
    }
    if (kTiles) _tile_release();
}

}  // namespace

bool narrow_rows(const HiddenRows& r, bool by_tiles) {
    // Weights of 8 outputs or fewer lie in half vectors.
    const bool fits = r.offset.width % 2 == 0 && r.offset.width <= kMaxNumbers &&
                      r.outputs > kTileOutputs / 2 && r.outputs <= kTileOutputs;
    if (!fits) return false;
    if (r.offset.pixels > 0) by_tiles ? run_rows<true>(r) : run_rows<false>(r);
    return true;
}

}  // namespace eventide::amx

#endif
