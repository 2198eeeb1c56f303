// How the pixels of a frame lie among latent samples, and among the tiles in which latent maps
// change.
#pragma once

#include "src/model/render/sampling.h"
#include "src/nn/tiling.h"

#include <array>
#include <vector>

namespace eventide {

/// One axis of a frame cut where its samples go over from one latent tile to the next.
struct AxisTiles {
    std::vector<int> begin;                ///< first pixel of each tile; one more than tiles
    std::vector<std::uint8_t> reads_next;  ///< per tile: whether it reads samples of the next too

    int count() const { return int(reads_next.size()); }
};

/// What a frame's columns read; the same for all its rows.
/// For 7 pixels over 4 samples of stride 1 (sample_axis()), linear:
///
///     side 0: pixel     0    1    2    3    4    5    6       those with a left sample
///             column    0    0    1    1    2    2    3       that sample
///             weight    1    .5   1    .5   1    .5   1
///     side 1: pixel          1         3         5            those between two
///             column         1         2         3
///             weight         .5        .5        .5
struct FrameColumns {
    // By side: the pixels that use their left (0) or right (1) sample.
    std::array<std::vector<int>, 2> pixel, column;
    std::array<std::vector<float>, 2> offset, weight;
    std::array<std::vector<std::size_t>, 2> tile;  ///< where tile c begins; one more than tiles
};

/// Tiles are those of the latent map, in its order: row of tiles times columns.count() + column.
/// Those in which no pixel of the frame has its first sample are counted, too.
struct FrameLayout {
    AxisTiles rows, columns;
    FrameColumns pixels;

    /// `row_edges`, `column_edges`: where latent tiles begin, and where the last ends.
    void make(const FrameGeometry& geometry, int latent_stride, Blend blend,
              const std::vector<int>& row_edges, const std::vector<int>& column_edges);
    std::size_t tiles() const { return std::size_t(rows.count()) * std::size_t(columns.count()); }
};

}  // namespace eventide
