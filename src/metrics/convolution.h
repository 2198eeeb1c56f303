// The three layers the perceptual networks are made of: convolution with ReLU, SqueezeNet's fire
// block, and max pooling.
#pragma once

#include "src/core/array.h"
#include "src/io/npz.h"
#include "src/nn/packed_weights.h"

#include <string>
#include <vector>

namespace eventide {

using FeatureMap = Array3<float>;  ///< [y][x][channel]

struct ConvolutionShape {
    int in = 0, out = 0;  ///< channels
    int kernel = 1, stride = 1, padding = 0;
};

/// relu(W * x + b), zeros outside the image.
class Convolution {
public:
    /// Takes `name`.weight, [out][in][y][x], and `name`.bias. Throws Error(input) where a shape is
    /// another than expected.
    Convolution(const NpzFile& file, const std::string& name, const ConvolutionShape& shape);

    /// Height or width of the output; at most 0 where the image is too small.
    int output_size(int n) const {
        return (n + 2 * shape_.padding - shape_.kernel) / shape_.stride + 1;
    }
    int out_channels() const { return shape_.out; }

    /// Into the channels [first, first + out_channels()) of `out`, which has the output's size.
    void process(const FeatureMap& in, FeatureMap& out, int first_channel = 0) const;

private:
    ConvolutionShape shape_;
    PackedWeights weights_;
};

/// SqueezeNet: a narrow 1x1 convolution, then 1x1 and 3x3 side by side.
class Fire {
public:
    Fire(const NpzFile& file, const std::string& name, int in, int squeezed, int expanded);
    int out_channels() const { return expand_1_.out_channels() + expand_3_.out_channels(); }
    FeatureMap process(const FeatureMap& in) const;

private:
    Convolution squeeze_, expand_1_, expand_3_;
};

/// Maximum over 3x3, stride 2. `ceil` also takes the last window that hangs over the edge.
FeatureMap max_pool(const FeatureMap& in, bool ceil);

/// `name` as an array of this shape. Throws Error(input) naming file, array, expected and found.
std::vector<float> weights_of(const NpzFile& file, const std::string& name,
                              const std::vector<std::int64_t>& shape);

}  // namespace eventide
