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

/// The same by vectors: eight pixels' sums at a time.
EVENTIDE_AMX void multiply_vectors(const HiddenRows& r, Room& room) {
    constexpr int kPixels = 8;
    const auto* weight = static_cast<const std::uint32_t*>(r.weight);
    for (int first = 0; first < kBoth; first += kPixels) {
        __m512 sums[kPixels];
        for (__m512& sum : sums) sum = _mm512_loadu_ps(r.bias);
        for (int k = 0; k < r.offset.width / 2; ++k) {
            const auto of_pair = (__m512bh)_mm512_loadu_si512(weight + k * kTileOutputs);
#pragma GCC unroll 8
            for (int p = 0; p < kPixels; ++p) {
                const auto pair = (__m512bh)_mm512_set1_epi32(unit_at(room.numbers[first + p], k));
                sums[p] = _mm512_dpbf16_ps(sums[p], pair, of_pair);
            }
        }
        for (int p = 0; p < kPixels; ++p)
            _mm512_store_ps(room.sums[first / kRun][first % kRun + p], sums[p]);
    }
}

/// The two rows of the last layer.
struct LastLayer {
    __m512 first, second;
};
/// relu(sums) times its rows, of the pixels of a run.
struct Products {
    const LastLayer& last;
    const float (*sums)[kTileOutputs];
    EVENTIDE_AMX_INLINE PairOfSums operator()(int p) const {
        const __m512 in = _mm512_max_ps(_mm512_load_ps(sums[p]), _mm512_setzero_ps());
        return {_mm512_mul_ps(in, last.first), _mm512_mul_ps(in, last.second)};
    }
};

EVENTIDE_AMX void two_outputs(const HiddenRows& r, const LastLayer& last, int first, int count,
                              const float (*sums)[kTileOutputs]) {
    put_outputs(r, Products{last, sums}, first, count);
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
        kTiles ? multiply_tiles(r, room) : multiply_vectors(r, room);
        two_outputs(r, last, first, count, room.sums[0]);
        if (count > kRun) two_outputs(r, last, first + kRun, count - kRun, room.sums[1]);
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
