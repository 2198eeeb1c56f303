// Convolutions and linear layers with their weights in the order the fast kernels read.
#pragma once

#include "src/kernels/bf16_kernels.h"
#include "src/kernels/plain/conv.h"
#include "src/nn/arithmetic.h"
#include "src/nn/onednn_conv.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace eventide {

/// Weights [stretch][position][output], packed for one of our kernels.
class PackedWeights {
public:
    PackedWeights() = default;
    /// `values` is [stretch][pixel][channel][output]: `pixels` pixels of `channels` per stretch.
    PackedWeights(int stretches, int pixels, int channels, int outputs,
                  const std::vector<float>& values, const std::vector<float>& bias, bool relu,
                  Products products);

    /// What reads bf16 numbers; null where float32 numbers are read.
    const Bf16Kernels* bf16() const { return bf16_; }
    int channels() const { return channels_; }
    int outputs() const { return outputs_; }
    /// Numbers of 4 bytes a pixel of input takes as the kernel reads it.
    int step() const { return bf16_ != nullptr ? (channels_ + 1) / 2 : channels_; }
    /// A row of outputs. `in` points at numbers of the kernel's own kind; pitch and step count
    /// numbers of 4 bytes.
    void run(const void* in, std::ptrdiff_t pitch, std::ptrdiff_t step, int count, float* out,
             std::ptrdiff_t out_step) const noexcept;

private:
    int stretches_ = 0, length_ = 0, channels_ = 0, outputs_ = 0, lanes_ = 0;
    bool relu_ = false;
    const Bf16Kernels* bf16_ = nullptr;
    std::vector<float, CacheLineAllocator<float>> weight_, bias_;
    std::vector<std::uint32_t, CacheLineAllocator<std::uint32_t>> narrow_;
};

class PackedConv {
public:
    PackedConv() = default;
    /// `extents`: of the regions run() is called for. Our own kernels take any region; they run
    /// every layer of 1x1.
    PackedConv(const plain::ConvWeights<float>& weights, int stride, bool relu,
               const Arithmetic& arithmetic, std::vector<Extent> extents = {});

    /// Scratch numbers run() needs for height x width outputs or fewer.
    std::size_t scratch_size(int height, int width) const;
    void run(const ConvCall& call, float* scratch) const noexcept;

private:
    int stride_ = 1, side_ = 3;
    PackedWeights weights_;                     // our own kernels'
    std::shared_ptr<const OnednnConv> onednn_;  // or null
};

}  // namespace eventide
