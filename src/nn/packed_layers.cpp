// The fast layers: packing, and whose kernels they call.
#include "src/nn/packed_layers.h"

#include "src/kernels/bf16_kernels.h"
#include "src/kernels/vector_kernels.h"

#include <utility>

namespace eventide {

PackedWeights::PackedWeights(int stretches, int pixels, int channels, int outputs,
                             const std::vector<float>& values, const std::vector<float>& bias,
                             bool relu, Products products)
    : stretches_(stretches),
      channels_(channels),
      outputs_(outputs),
      relu_(relu),
      bf16_(products == Products::f32    ? nullptr
            : products == Products::bf16 ? bf16_kernels()
                                         : &plain::bf16_kernels()) {
    length_ = pixels * step();
    const auto value = [&](int s, int pixel, int c, int o) {
        return values[std::size_t(((s * pixels + pixel) * channels + c) * outputs + o)];
    };
    if (bf16_ != nullptr) {
        const auto pair = [&](int s, int k, int o) {
            const int pixel = k / step(), c = k % step() * 2;
            const std::uint32_t low = to_bf16(value(s, pixel, c, o));
            const std::uint32_t high =
                c + 1 < channels ? to_bf16(value(s, pixel, c + 1, o)) : std::uint16_t{0};
            return low | high << 16;
        };
        lanes_ = bf16_lanes(outputs);
        narrow_.resize(packed_size(stretches, length_, outputs, lanes_));
        pack_weights(stretches, length_, outputs, lanes_, pair, narrow_.data());
    } else {
        const auto single = [&](int s, int k, int o) {
            return value(s, k / channels, k % channels, o);
        };
        lanes_ = dot_lanes(outputs);
        weight_.resize(packed_size(stretches, length_, outputs, lanes_));
        pack_weights(stretches, length_, outputs, lanes_, single, weight_.data());
    }
    const int lanes = std::max(kBf16Lanes, vector_kernels().lanes);
    bias_.resize(std::size_t((outputs + lanes - 1) / lanes * lanes));
    std::ranges::copy(bias, bias_.begin());
}

void PackedWeights::run(const void* in, std::ptrdiff_t pitch, std::ptrdiff_t step, int count,
                        float* out, std::ptrdiff_t out_step) const noexcept {
    if (bf16_ != nullptr)
        bf16_->dot_rows({static_cast<const std::uint32_t*>(in), pitch, step, stretches_, length_,
                         count, outputs_, narrow_.data(), bias_.data(), relu_, out, out_step});
    else
        vector_kernels().dot_rows({static_cast<const float*>(in), pitch, step, stretches_, length_,
                                   count, outputs_, lanes_, weight_.data(), bias_.data(), relu_,
                                   out, out_step});
}

PackedConv::PackedConv(const plain::ConvWeights<float>& weights, int stride, bool relu,
                       const Arithmetic& arithmetic, std::vector<Extent> extents)
    : stride_(stride), side_(weights.side) {
    if (arithmetic.onednn && side_ == 3) {
        onednn_ = std::make_shared<const OnednnConv>(weights, stride, relu, arithmetic.bf16(),
                                                     std::move(extents));
        return;
    }
    std::vector<float> values;  // [y][x][in][out]
    values.reserve(weights.weight.size());
    const int taps = side_ * side_;
    for (int tap = 0; tap < taps; ++tap)
        for (int i = 0; i < weights.in; ++i)
            for (int o = 0; o < weights.out; ++o)
                values.push_back(weights.weight[std::size_t((o * weights.in + i) * taps + tap)]);
    weights_ = {side_,  side_,        weights.in, weights.out,
                values, weights.bias, relu,       arithmetic.products};
}

std::size_t PackedConv::scratch_size(int height, int width) const {
    if (onednn_ != nullptr) return onednn_->scratch_size();
    if (weights_.bf16() == nullptr) return 0;
    return std::size_t((height - 1) * stride_ + side_) *
           std::size_t((width - 1) * stride_ + side_) * std::size_t(weights_.step());
}

void PackedConv::run(const ConvCall& call, float* scratch) const noexcept {
    if (onednn_ != nullptr) {
        onednn_->run(call, scratch);
        return;
    }
    const void* in = call.in;
    std::ptrdiff_t pitch = call.in_pitch;
    if (const Bf16Kernels* bf16 = weights_.bf16()) {
        const int rows = (call.height - 1) * stride_ + side_,
                  columns = (call.width - 1) * stride_ + side_;
        pitch = std::ptrdiff_t(columns) * weights_.step();
        // The scratch holds pairs of bf16 numbers in the room of one float each.
        auto* pixels_to_bf16 = reinterpret_cast<std::uint32_t*>(scratch);
        for (int y = 0; y < rows; ++y)
            bf16->pixels_to_bf16(call.in + y * call.in_pitch, std::size_t(columns),
                                 weights_.channels(), pixels_to_bf16 + y * pitch);
        in = pixels_to_bf16;
    }
    for (int y = 0; y < call.height; ++y) {
        // Both kinds of number are 4 bytes.
        const void* row = static_cast<const float*>(in) + y * stride_ * pitch;
        weights_.run(row, pitch, std::ptrdiff_t(stride_) * weights_.step(), call.width,
                     call.out + y * call.out_pitch, call.out_step);
    }
}

}  // namespace eventide
