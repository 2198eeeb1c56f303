// See packed_weights.h.
#include "src/nn/packed_weights.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#include <utility>

namespace eventide {

/// In the order in which the kernels go through them, so that they are read one after the other.
/// For outputs 0 .. 39 and vectors of 16 (L):
///
///     outputs 0 .. 31, a block of two vectors      then 32 .. 39, a block of one
///     stretch 0   pixel 0  unit 0   w0 .. w31      stretch 0 ...   w32 .. w39, 8 zeros
///                          unit 1   w0 .. w31
///                 pixel 1  unit 0   ...            unit: a channel in float32, in bf16 a pair of
///     stretch 1   ...                              channels, whose two numbers lie side by side
template <typename Number, typename Value>
void PackedWeights::pack(int lanes, const Value& value, Number* packed) const {
    for (int first = 0; first < outputs_;) {
        const int block = outputs_ - first > lanes ? 2 * lanes : lanes;
        for (std::size_t s = 0; s < shapes_.size(); ++s)
            for (int pixel = 0; pixel < shapes_[s].pixels; ++pixel)
                for (int unit = 0; unit < numbers_.units(shapes_[s].channels); ++unit)
                    for (int o = first; o < first + block; ++o)
                        *packed++ = o < outputs_ ? value(int(s), pixel, unit, o) : Number{0};
        first += block;
    }
}

PackedWeights::PackedWeights(std::vector<Shape> stretches, int outputs, const At& weight,
                             const std::vector<float>& bias, bool relu, const Backend& backend)
    : shapes_(std::move(stretches)), outputs_(outputs), relu_(relu), numbers_(backend) {
    int length = 0;
    for (const Shape& shape : shapes_) length += shape.pixels * numbers_.units(shape.channels);
    if (numbers_.bf16() != nullptr) {
        const auto pair = [&](int s, int pixel, int unit, int o) {
            const int c = 2 * unit;
            const std::uint32_t low = to_bf16(weight(s, pixel, c, o));
            const std::uint32_t high = c + 1 < shapes_[std::size_t(s)].channels
                                           ? to_bf16(weight(s, pixel, c + 1, o))
                                           : std::uint16_t{0};
            return low | high << 16;
        };
        lanes_ = bf16_lanes(outputs);
        pairs_.resize(packed_size(1, length, outputs, lanes_));
        pack(lanes_, pair, pairs_.data());
    } else {
        lanes_ = dot_lanes(numbers_.kernels(), outputs);
        weight_.resize(packed_size(1, length, outputs, lanes_));
        pack(lanes_, weight, weight_.data());
    }
    // Whole vectors, whichever kernel reads them.
    const int lanes = std::max(kBf16Lanes, numbers_.kernels().lanes);
    bias_.resize(std::size_t((outputs + lanes - 1) / lanes * lanes));
    std::ranges::copy(bias, bias_.begin());
}

PackedWeights::PackedWeights(int stretches, int pixels, int channels, int outputs,
                             const std::vector<float>& values, const std::vector<float>& bias,
                             bool relu, const Backend& backend)
    : PackedWeights(
          std::vector<Shape>(std::size_t(stretches), Shape{pixels, channels}), outputs,
          [&](int s, int pixel, int c, int o) {
              return values[std::size_t(((s * pixels + pixel) * channels + c) * outputs + o)];
          },
          bias, relu, backend) {}

void PackedWeights::run(DotArea area) const noexcept {
    area.outputs = outputs_;
    area.lanes = lanes_;
    area.bias = bias_.data();
    area.relu = relu_;
    if (const Bf16Kernels* bf16 = numbers_.bf16()) {
        area.weight = pairs_.data();
        bf16->dot_area(area);
    } else {
        area.weight = weight_.data();
        area.to_bf16 = false;
        numbers_.kernels().dot_area(area);
    }
}

bool PackedWeights::run(HiddenRows rows) const noexcept {
    if (!relu_) return false;
    rows.bias = bias_.data();
    rows.outputs = outputs_;
    if (const Bf16Kernels* bf16 = numbers_.bf16()) {
        rows.weight = pairs_.data();
        return bf16->hidden_rows != nullptr && bf16->hidden_rows(rows);
    }
    rows.weight = weight_.data();
    return lanes_ == numbers_.kernels().lanes && numbers_.kernels().hidden_rows(rows);
}

void PackedWeights::run(const void* in, std::ptrdiff_t pitch, std::ptrdiff_t step, int count,
                        float* out, std::ptrdiff_t out_step) const noexcept {
    constexpr std::size_t kMax = 16;
    std::array<Stretch, kMax> stretches;
    assert(shapes_.size() <= kMax);
    for (std::size_t s = 0; s < shapes_.size(); ++s)
        stretches[s] = {static_cast<const float*>(in) + std::ptrdiff_t(s) * pitch, step, 0,
                        shapes_[s].pixels * this->step()};
    DotArea area;
    area.stretches = stretches.data();
    area.count = int(shapes_.size());
    area.height = 1;
    area.width = count;
    area.out = out;
    area.out_step = out_step;
    run(area);
}

}  // namespace eventide
