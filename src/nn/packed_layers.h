// Convolutions and linear layers with their weights in the order the fast kernels read.
#pragma once

#include "src/kernels/plain/conv.h"
#include "src/nn/backend.h"
#include "src/nn/numbers.h"
#include "src/nn/onednn_conv.h"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace eventide {

using FloatBuffer = std::vector<float, CacheLineAllocator<float>>;

/// Weights [stretch][position][output], packed for one of our kernels.
class PackedWeights {
public:
    /// What a stretch of inputs is: so many pixels of so many channels.
    struct Shape {
        int pixels, channels;
    };
    using At = std::function<float(int stretch, int pixel, int channel, int output)>;

    PackedWeights() = default;
    PackedWeights(std::vector<Shape> stretches, int outputs, const At& weight,
                  const std::vector<float>& bias, bool relu, const Backend& backend);
    /// `values` is [stretch][pixel][channel][output]: `pixels` pixels of `channels` per stretch.
    PackedWeights(int stretches, int pixels, int channels, int outputs,
                  const std::vector<float>& values, const std::vector<float>& bias, bool relu,
                  const Backend& backend);

    const Numbers& numbers() const { return numbers_; }
    int channels() const { return shapes_.front().channels; }
    int outputs() const { return outputs_; }
    bool empty() const { return shapes_.empty(); }
    /// Units a pixel of input takes as the kernel reads it.
    int step() const { return numbers_.units(channels()); }
    /// Offsets, this as the only hidden layer, and the last; false, and nothing done, where no
    /// kernel does them at once.
    bool run(HiddenRows rows) const noexcept;
    /// Fills in what the weights know of an area.
    void run(DotArea area) const noexcept;
    /// A row of outputs. `in` points at numbers of the kernel's own kind; pitch and step count
    /// units.
    void run(const void* in, std::ptrdiff_t pitch, std::ptrdiff_t step, int count, float* out,
             std::ptrdiff_t out_step) const noexcept;

private:
    template <typename Number, typename Value>
    void pack(int lanes, const Value& value, Number* packed) const;

    std::vector<Shape> shapes_;
    int outputs_ = 0, lanes_ = 0;
    bool relu_ = false;
    Numbers numbers_;
    /// weight_ is filled where the layer reads float32, pairs_ where it reads bf16; the other is
    /// empty. bias_: outputs rounded up to whole vectors, zeros beyond them.
    FloatBuffer weight_, bias_;
    std::vector<std::uint32_t, CacheLineAllocator<std::uint32_t>> pairs_;
};

/// One of the maps whose channels a convolution reads side by side: numbers of the layer's kind,
/// beginning with the pixel up and left of the first output's centre.
struct ConvSource {
    const void* in = nullptr;
    std::ptrdiff_t pitch = 0;  ///< units from one row to the next
};

/// Where a convolution reads and writes.
struct ConvArea {
    static constexpr int kMaxSources = 3;
    std::array<ConvSource, kMaxSources> in{};
    void* out = nullptr;           ///< pixels of a row one after the other
    std::ptrdiff_t out_pitch = 0;  ///< units between rows
    bool to_bf16 = false;          ///< outputs of the kind that layers read, else float32
    int height = 0, width = 0;     ///< outputs
};

class PackedConv {
public:
    PackedConv() = default;
    /// `extents`: of the regions run() is called for. Our own kernels take any region; they run
    /// every layer of 1x1. `sources`: how many of the input's channels lie in which map; all in one
    /// where it is empty. `as_one`: products are summed up as if all lay in one, whatever `sources`
    /// says.
    PackedConv(const plain::ConvWeights<float>& weights, int stride, bool relu,
               const Backend& backend, std::vector<Extent> extents = {},
               std::vector<int> sources = {}, bool as_one = false);

    const Numbers& numbers() const { return single_.numbers(); }
    /// Scratch numbers run() needs for height x width outputs or fewer.
    std::size_t scratch_size(int height, int width) const;
    void run(const ConvArea& area, float* scratch) const noexcept;
    /// Of one map of float32 numbers, which are converted on the way where layers read bf16.
    void run(const ConvCall& call, float* scratch) const noexcept;

private:
    PackedWeights packed(const plain::ConvWeights<float>& weights, int pixels, bool relu,
                         const Backend& backend) const;
    void run_own(const ConvArea& area, std::ptrdiff_t out_step) const noexcept;
    void run_part(const ConvArea& area, std::ptrdiff_t out_step, int first, int count,
                  int at_once) const noexcept;
    void run_onednn(const ConvArea& area, float* scratch) const noexcept;
    bool by_quads() const;
    template <typename Body>
    void over_stretches(const Body& body) const;
    void gather(const ConvArea& area, void* dense) const noexcept;
    int reach(int outputs) const { return (outputs - 1) * stride_ + side_; }

    int stride_ = 1, side_ = 3, inputs_ = 0, outputs_ = 0;
    std::vector<int> sources_;  // channels
    bool as_one_ = false;
    /// Our own kernels' weights: for one output pixel; and for two beside each other, where the
    /// outputs of one fill but half a vector.
    PackedWeights single_, pair_;
    std::shared_ptr<const OnednnConv> onednn_;  // or null
};

}  // namespace eventide
