// What a voxel grid says of each pixel over all its bins.
#include "src/binning/grid_sums.h"

namespace eventide {
namespace {

constexpr std::size_t kPolarity = 0, kCount = 3, kPerBin = 4;  // VoxelGrid's channels

void sum_over_bins(const VoxelGrid& grid, std::size_t channel, Array2<float>& sums) {
    const auto channels = std::size_t(grid.values.channels());
    const float* pixel = grid.values.values().data();
    for (float& sum : sums.values()) {
        sum = 0;
        for (std::size_t c = channel; c + 1 < channels; c += kPerBin) sum += pixel[c];
        pixel += channels;
    }
}

}  // namespace

void sum_polarities(const VoxelGrid& grid, Array2<float>& sums) noexcept {
    sum_over_bins(grid, kPolarity, sums);
}

void count_events(const VoxelGrid& grid, Array2<float>& counts) noexcept {
    sum_over_bins(grid, kCount, counts);
}

}  // namespace eventide
