// Arrays, mirrored.
#include "src/model/mirrors.h"

#include "src/core/error.h"

#include <algorithm>
#include <cstddef>
#include <string>

namespace eventide {
namespace {

/// [y][x] of `size` numbers each.
template <typename T>
void mirror_pixels(const T* from, int height, int width, std::size_t size, Mirror axes, T* into) {
    const auto row = std::size_t(width) * size;
    for (int y = 0; y < height; ++y) {
        const T* source = from + std::size_t(axes.y ? height - 1 - y : y) * row;
        T* target = into + std::size_t(y) * row;
        if (!axes.x) {
            std::copy_n(source, row, target);
            continue;
        }
        source += row;
        for (int x = 0; x < width; ++x, target += size) std::copy_n(source -= size, size, target);
    }
}

}  // namespace

void mirror(const VoxelGrid& grid, Mirror axes, VoxelGrid& into) noexcept {
    copy_stamp(grid, into);
    const auto& values = grid.values;
    mirror_pixels(values.values().data(), values.height(), values.width(),
                  std::size_t(values.channels()), axes, into.values.values().data());
    if (grid.touched.empty()) {
        into.touched = {};
        return;
    }
    if (into.touched.empty()) into.touched = {values.height(), values.width()};
    mirror_pixels(grid.touched.values().data(), values.height(), values.width(), 1, axes,
                  into.touched.values().data());
}

void mirror(Array2<float>& map, Mirror axes) noexcept {
    const int height = map.height();
    for (int y = 0; axes.x && y < height; ++y) std::ranges::reverse(map.row(y));
    for (int y = 0; axes.y && y < height / 2; ++y)
        std::ranges::swap_ranges(map.row(y), map.row(height - 1 - y));
}

FrameGeometry mirror(FrameGeometry geometry, Mirror axes) noexcept {
    if (axes.x) geometry.x = geometry.width - geometry.x - geometry.part_width;
    if (axes.y) geometry.y = geometry.height - geometry.y - geometry.part_height;
    return geometry;
}

void check_self_ensemble(int views) {
    if (views != 1 && views != 2 && views != 4)
        throw Error(ErrorKind::usage,
                    "self-ensemble: expected 1, 2 or 4 views, found " + std::to_string(views));
}

double error_of_mean(int views) {
    return views == 1 ? 1 : views == 2 ? .95 : .94;
}

}  // namespace eventide
