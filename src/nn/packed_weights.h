// Weights in the order the fast kernels read them.
#pragma once

#include "src/core/array.h"
#include "src/nn/backend.h"
#include "src/nn/numbers.h"

#include <cstdint>
#include <functional>
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

}  // namespace eventide
