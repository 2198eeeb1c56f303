// AMX's tile registers: what they hold, and how they are filled.
#pragma once

#include <immintrin.h>

#include <cstddef>
#include <cstdint>

#define EVENTIDE_AMX \
    __attribute__((target("amx-tile,amx-bf16,avx512f,avx512bw,avx512vl,avx512dq,avx512bf16")))
#define EVENTIDE_AMX_INLINE EVENTIDE_AMX __attribute__((always_inline)) inline

namespace eventide::amx {

constexpr int kTileRows = 16, kTileOutputs = 16;

/// What the tile registers hold, as the processor wants to be told.
/// One shape for all of an area:
///
///     byte    0          1        2 to 15     16 to 47                 48 to 63
///             palette    start    reserved    bytes of a row, 8 x 2    rows, 8 x 1
///
/// C has `pixels` rows of 16 float32 sums, A `pixels` rows of `pairs` units, B `pairs` rows of 16
/// units. A register has 16 rows of 64 bytes, hence at most 16 pixels and 16 pairs.
struct alignas(64) TileShapes {
    std::uint8_t palette = 1, start = 0, reserved[14] = {};
    std::uint16_t row_bytes[16] = {};
    std::uint8_t rows[16] = {};

    /// C in 0 to 3, A in 4 and 5, B in 6 and 7.
    TileShapes(int pixels, int pairs) {
        for (int i = 0; i < 8; ++i) {
            row_bytes[i] = std::uint16_t(i == 4 || i == 5 ? 4 * pairs : 4 * kTileOutputs);
            rows[i] = std::uint8_t(i < 6 ? pixels : pairs);
        }
    }
};

// Tile registers are named in the instruction, so they cannot be counted through.
template <int kTile>
EVENTIDE_AMX_INLINE void load_tile(const void* from, std::ptrdiff_t step) {
    if constexpr (kTile == 0) _tile_loadd(0, from, step);
    if constexpr (kTile == 1) _tile_loadd(1, from, step);
    if constexpr (kTile == 2) _tile_loadd(2, from, step);
    if constexpr (kTile == 3) _tile_loadd(3, from, step);
    if constexpr (kTile == 4) _tile_loadd(4, from, step);
    if constexpr (kTile == 5) _tile_loadd(5, from, step);
    if constexpr (kTile == 6) _tile_loadd(6, from, step);
    if constexpr (kTile == 7) _tile_loadd(7, from, step);
}
template <int kTile>
EVENTIDE_AMX_INLINE void store_tile(void* to, std::ptrdiff_t step) {
    if constexpr (kTile == 0) _tile_stored(0, to, step);
    if constexpr (kTile == 1) _tile_stored(1, to, step);
    if constexpr (kTile == 2) _tile_stored(2, to, step);
    if constexpr (kTile == 3) _tile_stored(3, to, step);
}

}  // namespace eventide::amx
