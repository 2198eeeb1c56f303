// How the pixels of a frame lie among latent samples, and among the tiles in which latent maps
// change.
#pragma once

#include "src/model/render/sampling.h"
#include "src/nn/tiling.h"

#include <array>
#include <vector>

namespace eventide {

/// Where the tiles of a latent map (latent_tiles()) begin along its rows or columns, and where the
/// last ends.
std::vector<int> latent_row_edges(int height);
std::vector<int> latent_column_edges(int width);

/// One axis of a frame cut where its samples go over from one latent tile to the next.
struct AxisTiles {
    std::vector<int> begin;  ///< first pixel of each tile; one more than tiles
    /// Per tile: whether pixels of the whole frame in it read samples of the next too.
    std::vector<std::uint8_t> reads_next;

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
    /// Whether `holds(tile)` of every latent tile that pixels in the one at row, column read.
    template <typename Holds>
    bool all_read(int row, int column, const Holds& holds) const {
        const auto r = std::size_t(row), c = std::size_t(column);
        for (std::size_t y = r; y <= r + rows.reads_next[r]; ++y)
            for (std::size_t x = c; x <= c + columns.reads_next[c]; ++x)
                if (!holds(y * std::size_t(columns.count()) + x)) return false;
        return true;
    }
};

}  // namespace eventide
