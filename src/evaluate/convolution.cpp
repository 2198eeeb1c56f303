// Convolution as a matrix product over gathered neighbourhoods (im2col).
#include "src/evaluate/convolution.h"

#include "src/core/error.h"

#include <Eigen/Core>

#include <algorithm>
#include <limits>

namespace eventide {
namespace {

using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Strided = Eigen::OuterStride<>;

// Neighbourhoods are gathered for about this many numbers at a time: they stay in the cache.
constexpr std::size_t kGatheredNumbers = 64 * 1024;

std::string shape_text(const std::vector<std::int64_t>& shape) {
    std::string text = "[";
    for (const std::int64_t n : shape) text += (text.size() > 1 ? ", " : "") + std::to_string(n);
    return text + "]";
}

}  // namespace

std::vector<float> weights_of(const NpzFile& file, const std::string& name,
                              const std::vector<std::int64_t>& shape) {
    NpzArray array = file.array(name);
    if (array.shape != shape)
        throw Error(ErrorKind::input, file.file() + ": array '" + name + "': expected shape " +
                                          shape_text(shape) + ", found " + shape_text(array.shape));
    return std::move(array.values);
}

Convolution::Convolution(const NpzFile& file, const std::string& name,
                         const ConvolutionShape& shape)
    : shape_(shape), bias_(weights_of(file, name + ".bias", {shape.out})) {
    const int k = shape.kernel;
    const auto stored = weights_of(file, name + ".weight", {shape.out, shape.in, k, k});
    weights_.resize(stored.size());
    std::size_t at = 0;
    for (int o = 0; o < shape.out; ++o)
        for (int i = 0; i < shape.in; ++i)
            for (int tap = 0; tap < k * k; ++tap)
                weights_[std::size_t((tap * shape.in + i) * shape.out + o)] = stored[at++];
}

void Convolution::process(const FeatureMap& in, FeatureMap& out, int first_channel) const {
    const auto [in_channels, out_channels, k, stride, padding] = shape_;
    const int depth = k * k * in_channels, width = out.width();
    const int pixels = out.height() * width;
    const int chunk = std::max(1, int(kGatheredNumbers / std::size_t(depth)));
    const bool in_place = k == 1 && stride == 1 && padding == 0;
    std::vector<float> gathered(in_place ? 0 : std::size_t(chunk) * std::size_t(depth));

    const Eigen::Map<const RowMajor> weights(weights_.data(), depth, out_channels);
    const Eigen::Map<const Eigen::RowVectorXf> bias(bias_.data(), out_channels);
    for (int begin = 0; begin < pixels; begin += chunk) {
        const int n = std::min(chunk, pixels - begin);
        const float* rows = in.values().data() + std::size_t(begin) * std::size_t(depth);
        if (!in_place) {
            std::fill(gathered.begin(), gathered.end(), 0.F);
            float* to = gathered.data();
            for (int p = begin; p < begin + n; ++p)
                for (int ky = 0; ky < k; ++ky)
                    for (int kx = 0; kx < k; ++kx, to += in_channels) {
                        const int y = p / width * stride + ky - padding;
                        const int x = p % width * stride + kx - padding;
                        if (y < 0 || y >= in.height() || x < 0 || x >= in.width()) continue;
                        std::ranges::copy(in.pixel(y, x), to);
                    }
            rows = gathered.data();
        }
        Eigen::Map<RowMajor, 0, Strided> result(
            out.values().data() + std::size_t(begin) * std::size_t(out.channels()) +
                std::size_t(first_channel),
            n, out_channels, Strided(out.channels()));
        result.noalias() = Eigen::Map<const RowMajor>(rows, n, depth) * weights;
        result = (result.rowwise() + bias).cwiseMax(0.F);
    }
}

Fire::Fire(const NpzFile& file, const std::string& name, int in, int squeezed, int expanded)
    : squeeze_(file, name + ".squeeze", {.in = in, .out = squeezed}),
      expand_1_(file, name + ".expand1x1", {.in = squeezed, .out = expanded}),
      expand_3_(file, name + ".expand3x3",
                {.in = squeezed, .out = expanded, .kernel = 3, .padding = 1}) {}

FeatureMap Fire::process(const FeatureMap& in) const {
    FeatureMap squeezed(in.height(), in.width(), squeeze_.out_channels());
    squeeze_.process(in, squeezed);
    FeatureMap out(in.height(), in.width(), out_channels());
    expand_1_.process(squeezed, out);
    expand_3_.process(squeezed, out, expand_1_.out_channels());
    return out;
}

FeatureMap max_pool(const FeatureMap& in, bool ceil) {
    const auto size = [ceil](int n) { return (n - 3 + (ceil ? 1 : 0)) / 2 + 1; };
    FeatureMap out(size(in.height()), size(in.width()), in.channels());
    std::ranges::fill(out.values(), -std::numeric_limits<float>::infinity());
    for (int y = 0; y < out.height(); ++y)
        for (int x = 0; x < out.width(); ++x)
            for (int dy = 0; dy < 3 && 2 * y + dy < in.height(); ++dy)
                for (int dx = 0; dx < 3 && 2 * x + dx < in.width(); ++dx) {
                    const auto from = in.pixel(2 * y + dy, 2 * x + dx);
                    const auto to = out.pixel(y, x);
                    for (std::size_t c = 0; c < from.size(); ++c) to[c] = std::max(to[c], from[c]);
                }
    return out;
}

}  // namespace eventide
