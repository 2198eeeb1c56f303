// Convolution by the fast kernels, a row of pixels at a time.
#include "src/metrics/convolution.h"

#include "src/core/error.h"
#include "src/core/list_text.h"

#include <algorithm>
#include <limits>

namespace eventide {
namespace {

std::string shape_text(const std::vector<std::int64_t>& shape) {
    return "[" + list_of(shape, [](std::int64_t n) { return std::to_string(n); }) + "]";
}

FeatureMap zero_padded(const FeatureMap& in, int padding) {
    FeatureMap out(in.height() + 2 * padding, in.width() + 2 * padding, in.channels());
    const auto row = std::size_t(in.width()) * std::size_t(in.channels());
    for (int y = 0; y < in.height(); ++y)
        std::copy_n(in.pixel(y, 0).data(), row, out.pixel(y + padding, padding).data());
    return out;
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
    : shape_(shape) {
    const int k = shape.kernel;
    const auto bias = weights_of(file, name + ".bias", {shape.out});
    const auto stored = weights_of(file, name + ".weight", {shape.out, shape.in, k, k});
    std::vector<float> turned(stored.size());  // [y][x][in][out]
    std::size_t at = 0;
    for (int o = 0; o < shape.out; ++o)
        for (int i = 0; i < shape.in; ++i)
            for (int tap = 0; tap < k * k; ++tap)
                turned[std::size_t((tap * shape.in + i) * shape.out + o)] = stored[at++];
    weights_ = PackedWeights(k, k, shape.in, shape.out, turned, bias, true, Backend{});
}

void Convolution::process(const FeatureMap& in, FeatureMap& out, int first_channel) const {
    const FeatureMap padded = shape_.padding > 0 ? zero_padded(in, shape_.padding) : FeatureMap{};
    const FeatureMap& from = shape_.padding > 0 ? padded : in;
    const std::ptrdiff_t pitch = std::ptrdiff_t{from.width()} * shape_.in;
    const std::ptrdiff_t out_pitch = std::ptrdiff_t{out.width()} * out.channels();
    for (int y = 0; y < out.height(); ++y)
        weights_.run(from.values().data() + y * shape_.stride * pitch, pitch,
                     std::ptrdiff_t{shape_.stride} * shape_.in, out.width(),
                     out.values().data() + y * out_pitch + first_channel, out.channels());
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
