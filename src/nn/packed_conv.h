// Convolutions of the fast engine, by our own kernels or oneDNN's.
#pragma once

#include "src/kernels/plain/conv.h"
#include "src/kernels/winograd.h"
#include "src/nn/conv_area.h"
#include "src/nn/onednn_conv.h"
#include "src/nn/packed_weights.h"
#include "src/nn/winograd_conv.h"

#include <memory>
#include <vector>

namespace eventide {

/// How a layer's products are summed up.
enum class Summation {
    best,      ///< map by map, or by Winograd's sums of a group of outputs where those pay
    as_one,    ///< the same, as if all channels lay in one map
    by_pixel,  ///< map by map: no output's bits hang on what its neighbours read
};

class PackedConv {
public:
    PackedConv() = default;
    /// `extents`: of the regions run() is called for. Our own kernels take any region; they run
    /// every layer of 1x1. `sources`: how many of the input's channels lie in which map; all in one
    /// where it is empty.
    PackedConv(const plain::ConvWeights<float>& weights, int stride, bool relu,
               const Backend& backend, std::vector<Extent> extents = {},
               std::vector<int> sources = {}, Summation summation = Summation::best);

    const Numbers& numbers() const { return numbers_; }
    /// Outputs of a row that are rounded together, counted from a region's first: where what one of
    /// them reads changes, so may the last bits of all.
    int group() const { return winograd_ != nullptr ? kWinogradOutputs : 1; }
    /// Scratch numbers run() needs for height x width outputs or fewer.
    std::size_t scratch_size(int height, int width) const;
    void run(const ConvArea& area, float* scratch) const noexcept;
    /// The same for one map of float32 numbers, which are converted on the way where layers read
    /// bf16.
    void run(const ConvCall& call, float* scratch) const noexcept;

private:
    PackedWeights packed(const plain::ConvWeights<float>& weights, int pixels, bool relu,
                         const Backend& backend) const;
    void run_own(const ConvArea& area, float* scratch) const noexcept;
    void run_part(const ConvArea& area, int first, int count, int at_once) const noexcept;
    void run_onednn(const ConvArea& area, float* scratch) const noexcept;
    bool by_quads() const;
    template <typename Body>
    void over_stretches(const Body& body) const;
    void gather(const ConvArea& area, void* dense) const noexcept;
    int reach(int outputs) const { return (outputs - 1) * stride_ + side_; }

    int stride_ = 1, side_ = 3, inputs_ = 0, outputs_ = 0;
    std::vector<int> sources_;  // channels
    bool as_one_ = false;
    Numbers numbers_;
    /// The weights of direct sums, empty where one of the two below does them: for one output
    /// pixel; and for two beside each other, where the outputs of one fill but half a vector.
    PackedWeights single_, pair_;
    // Or null. The first does layers of 3x3 and stride 1 that are wide enough.
    std::shared_ptr<const WinogradConv> winograd_;
    std::shared_ptr<const OnednnConv> onednn_;
};

}  // namespace eventide
