// What a voxel grid says of each pixel over all its bins.
#pragma once

#include "src/core/frame_data.h"

namespace eventide {

/// Sum of polarities, [y][x].
void sum_polarities(const VoxelGrid& grid, Array2<float>& sums) noexcept;

/// Number of events, [y][x].
void count_events(const VoxelGrid& grid, Array2<float>& counts) noexcept;

}  // namespace eventide
