// 3x3 convolutions in float32 with half of the products (src/kernels/winograd.h says how).
#pragma once

#include "src/kernels/plain/conv.h"
#include "src/nn/conv_area.h"
#include "src/nn/packed_weights.h"

#include <vector>

namespace eventide {

/// Stride 1, by our own kernels in float32. Outputs go by groups of four, counted from a region's
/// first pixel: a region comes out to the same bits each time, a part of it to other last bits.
class WinogradConv {
public:
    /// `sources`: how many of the input's channels lie in which map.
    WinogradConv(const plain::ConvWeights<float>& weights, const std::vector<int>& sources,
                 bool relu, const Backend& backend);

    /// Scratch numbers run() needs for height x width outputs or fewer.
    std::size_t scratch_size(int height, int width) const;
    /// On any number of threads, each with its own scratch memory.
    void run(const ConvArea& area, float* scratch) const noexcept;

private:
    void run_band(const ConvArea& area, float* scratch) const noexcept;

    int inputs_, outputs_;
    std::vector<int> sources_;
    bool relu_;
    std::vector<float> bias_;
    std::vector<PackedWeights> positions_;
};

}  // namespace eventide
