// See frame_layout.h.
#include "src/model/render/frame_layout.h"

#include <algorithm>

namespace eventide {
namespace {

/// `at(i)`: the samples of pixel i of `whole`, of which n from `first` on are wanted.
template <typename At>
AxisTiles cut(int whole, int first, int n, const std::vector<int>& edges, const At& at) {
    AxisTiles tiles;
    int i = 0;
    for (std::size_t t = 0; t + 1 < edges.size(); ++t) {
        tiles.begin.push_back(std::clamp(i - first, 0, n));
        bool reads_next = false;
        for (; i < whole; ++i) {
            // Pixels belong to the tile of their first sample; the second may be the next tile's.
            const AxisSamples samples = at(i);
            if (samples.index >= edges[t + 1]) break;
            reads_next |= samples.weight[1] != 0 && samples.index + 1 >= edges[t + 1];
        }
        tiles.reads_next.push_back(std::uint8_t(reads_next));
    }
    tiles.begin.push_back(n);
    return tiles;
}

}  // namespace

std::vector<int> latent_row_edges(int height) {
    std::vector<int> edges;
    for (const Tile& tile : latent_tiles(height, 1)) edges.push_back(tile.y0);
    edges.push_back(height);
    return edges;
}

std::vector<int> latent_column_edges(int width) {
    std::vector<int> edges;
    for (const Tile& tile : latent_tiles(1, width)) edges.push_back(tile.x0);
    edges.push_back(width);
    return edges;
}

void FrameLayout::make(const FrameGeometry& geometry, int latent_stride, Blend blend,
                       const std::vector<int>& row_edges, const std::vector<int>& column_edges) {
    const auto column = [&](int i) {
        return sample_axis(i, geometry.width, geometry.sensor_width, latent_stride, blend);
    };
    rows = cut(geometry.height, geometry.y, geometry.part_height, row_edges, [&](int i) {
        return sample_axis(i, geometry.height, geometry.sensor_height, latent_stride, blend);
    });
    columns = cut(geometry.width, geometry.x, geometry.part_width, column_edges, column);
    pixels = {};
    for (std::size_t side = 0; side < 2; ++side) {
        for (int c = 0; c < columns.count(); ++c) {
            pixels.tile[side].push_back(pixels.pixel[side].size());
            for (int i = columns.begin[std::size_t(c)]; i < columns.begin[std::size_t(c) + 1];
                 ++i) {
                const AxisSamples x = column(geometry.x + i);
                if (x.weight[side] == 0) continue;
                pixels.pixel[side].push_back(i);
                pixels.column[side].push_back(x.index + int(side));
                pixels.offset[side].push_back(float(x.offset[side]));
                pixels.weight[side].push_back(float(x.weight[side]));
            }
        }
        pixels.tile[side].push_back(pixels.pixel[side].size());
    }
}

}  // namespace eventide
