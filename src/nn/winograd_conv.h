// 3x3 convolutions with half of the products (src/kernels/winograd.h says how).
#pragma once

#include "src/kernels/plain/conv.h"
#include "src/nn/conv_area.h"
#include "src/nn/packed_weights.h"

#include <vector>

namespace eventide {

/// Stride 1, by our own kernels in float32, or in bf16 where those have the sums. Outputs go by
/// groups of four, counted from a region's first pixel: a region comes out to the same bits each
/// time, a part of it to other last bits.
class WinogradConv {
public:
    /// `sources`: how many of the input's channels lie in which map; in bf16 even numbers.
    WinogradConv(const plain::ConvWeights<float>& weights, const std::vector<int>& sources,
                 bool relu, const Backend& backend);

    /// Scratch numbers run() needs for height x width outputs or fewer.
    std::size_t scratch_size(int height, int width) const;
    /// On any number of threads, each with its own scratch memory.
    void run(const ConvArea& area, float* scratch) const noexcept;

private:
    const Numbers& numbers() const { return positions_.front().numbers(); }
    int units() const { return numbers().units(inputs_); }
    void run_band(const ConvArea& band, float* scratch) const noexcept;
    void sum_pixels(const ConvArea& band, std::ptrdiff_t plane, float* channels) const noexcept;

    int inputs_, outputs_;
    std::vector<int> sources_;
    bool relu_;
    std::vector<float> bias_;
    std::vector<PackedWeights> positions_;
};

}  // namespace eventide
