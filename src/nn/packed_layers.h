// Convolutions and linear layers with their weights in the order the fast kernels read.
#pragma once

#include "src/kernels/plain/conv.h"

#include <cstdint>
#include <vector>

namespace eventide {

/// Whether products are made of bf16 numbers, and whether it pays: measured once per process, so
/// that everything made in it agrees.
bool bf16_available();
bool bf16_is_faster();

/// Weights [stretch][position][output], packed for one of the kernels.
class PackedWeights {
public:
    PackedWeights() = default;
    /// `values` is [stretch][pixel][channel][output]: `pixels` pixels of `channels` per stretch.
    PackedWeights(int stretches, int pixels, int channels, int outputs,
                  const std::vector<float>& values, const std::vector<float>& bias, bool relu,
                  bool bf16);

    bool bf16() const { return bf16_; }
    int channels() const { return channels_; }
    int outputs() const { return outputs_; }
    /// Numbers of 4 bytes a pixel of input takes as the kernel reads it.
    int step() const { return bf16_ ? (channels_ + 1) / 2 : channels_; }
    /// A row of outputs. `in` points at numbers of the kernel's own kind; pitch and step count
    /// numbers of 4 bytes.
    void run(const void* in, std::ptrdiff_t pitch, std::ptrdiff_t step, int count, float* out,
             std::ptrdiff_t out_step) const noexcept;

private:
    int stretches_ = 0, length_ = 0, channels_ = 0, outputs_ = 0;
    bool relu_ = false, bf16_ = false;
    std::vector<float, CacheLineAllocator<float>> weight_, bias_;
    std::vector<std::uint32_t, CacheLineAllocator<std::uint32_t>> narrow_;
};

/// Where a convolution reads and writes: `in` is the pixel up and left of the first output's
/// centre.
struct ConvCall {
    const float* in = nullptr;
    std::ptrdiff_t in_pitch = 0;  ///< numbers from one row to the next
    float* out = nullptr;
    std::ptrdiff_t out_pitch = 0, out_step = 0;  ///< numbers between rows, pixels
    int height = 0, width = 0;                   ///< outputs
};

class PackedConv {
public:
    PackedConv() = default;
    PackedConv(const plain::ConvWeights<float>& weights, int stride, bool relu, bool bf16);

    /// Scratch numbers run() needs for height x width outputs.
    std::size_t scratch_size(int height, int width) const;
    void run(const ConvCall& call, float* scratch) const noexcept;

private:
    int stride_ = 1;
    PackedWeights weights_;
};

}  // namespace eventide
