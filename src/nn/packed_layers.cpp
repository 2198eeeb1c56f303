// The fast layers: packing, and the choice between float32 and bf16 products.
#include "src/nn/packed_layers.h"

#include "src/kernels/bf16_kernels.h"
#include "src/kernels/vector_kernels.h"

#include <chrono>
#include <limits>

namespace eventide {
namespace {

/// The shortest of a few runs: whatever else the machine does only adds.
double seconds_of(const PackedConv& conv, const ConvCall& call, float* scratch) {
    double best = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 12; ++i) {
        const auto begin = std::chrono::steady_clock::now();
        conv.run(call, scratch);
        const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
        best = std::min(best, taken.count());
    }
    return best;
}

/// Of a typical layer; bf16 must win clearly, since it costs accuracy.
bool measure_bf16() {
    constexpr int kSide = 24, kChannels = 64;
    constexpr double kWorthwhile = 1.2;
    if (!bf16_available()) return false;
    plain::ConvWeights<float> weights{kChannels, kChannels, {}, {}};
    weights.weight.assign(std::size_t(kChannels) * kChannels * 9, 0.1F);
    weights.bias.assign(kChannels, 0.0F);
    Array3<float> in{kSide + 2, kSide + 2, kChannels}, out{kSide, kSide, kChannels};
    std::ranges::fill(in.values(), 1.0F);
    const ConvCall call{in.values().data(),
                        std::ptrdiff_t(kSide + 2) * kChannels,
                        out.values().data(),
                        std::ptrdiff_t(kSide) * kChannels,
                        kChannels,
                        kSide,
                        kSide};
    const PackedConv wide{weights, 1, true, false}, narrow{weights, 1, true, true};
    std::vector<float> scratch(narrow.scratch_size(kSide, kSide));
    return seconds_of(wide, call, nullptr) > kWorthwhile * seconds_of(narrow, call, scratch.data());
}

}  // namespace

bool bf16_available() {
    return bf16_kernels() != nullptr;
}

bool bf16_is_faster() {
    static const bool kFaster = measure_bf16();
    return kFaster && bf16_available();
}

PackedWeights::PackedWeights(int stretches, int pixels, int channels, int outputs,
                             const std::vector<float>& values, const std::vector<float>& bias,
                             bool relu, bool bf16)
    : stretches_(stretches), channels_(channels), outputs_(outputs), relu_(relu), bf16_(bf16) {
    length_ = pixels * step();
    const auto value = [&](int s, int pixel, int c, int o) {
        return values[std::size_t(((s * pixels + pixel) * channels + c) * outputs + o)];
    };
    if (bf16) {
        const auto pair = [&](int s, int k, int o) {
            const int pixel = k / step(), c = k % step() * 2;
            const std::uint32_t low = to_bf16(value(s, pixel, c, o));
            const std::uint32_t high =
                c + 1 < channels ? to_bf16(value(s, pixel, c + 1, o)) : std::uint16_t{0};
            return low | high << 16;
        };
        narrow_.resize(packed_size(stretches, length_, outputs, kBf16Lanes));
        pack_weights(stretches, length_, outputs, kBf16Lanes, pair, narrow_.data());
    } else {
        const auto single = [&](int s, int k, int o) {
            return value(s, k / channels, k % channels, o);
        };
        const int lanes = vector_kernels().lanes;
        weight_.resize(packed_size(stretches, length_, outputs, lanes));
        pack_weights(stretches, length_, outputs, lanes, single, weight_.data());
    }
    const int lanes = std::max(kBf16Lanes, vector_kernels().lanes);
    bias_.resize(std::size_t((outputs + lanes - 1) / lanes * lanes));
    std::ranges::copy(bias, bias_.begin());
}

void PackedWeights::run(const void* in, std::ptrdiff_t pitch, std::ptrdiff_t step, int count,
                        float* out, std::ptrdiff_t out_step) const noexcept {
    if (bf16_)
        bf16_kernels()->dot_rows({static_cast<const std::uint32_t*>(in), pitch, step, stretches_,
                                  length_, count, outputs_, narrow_.data(), bias_.data(), relu_,
                                  out, out_step});
    else
        vector_kernels().dot_rows({static_cast<const float*>(in), pitch, step, stretches_, length_,
                                   count, outputs_, weight_.data(), bias_.data(), relu_, out,
                                   out_step});
}

PackedConv::PackedConv(const plain::ConvWeights<float>& weights, int stride, bool relu, bool bf16)
    : stride_(stride) {
    std::vector<float> values;  // [y][x][in][out]
    values.reserve(weights.weight.size());
    for (int tap = 0; tap < 9; ++tap)
        for (int i = 0; i < weights.in; ++i)
            for (int o = 0; o < weights.out; ++o)
                values.push_back(weights.weight[std::size_t((o * weights.in + i) * 9 + tap)]);
    weights_ = {3, 3, weights.in, weights.out, values, weights.bias, relu, bf16};
}

std::size_t PackedConv::scratch_size(int height, int width) const {
    if (!weights_.bf16()) return 0;
    return std::size_t((height - 1) * stride_ + 3) * std::size_t((width - 1) * stride_ + 3) *
           std::size_t(weights_.step());
}

void PackedConv::run(const ConvCall& call, float* scratch) const noexcept {
    const void* in = call.in;
    std::ptrdiff_t pitch = call.in_pitch;
    if (weights_.bf16()) {
        const int rows = (call.height - 1) * stride_ + 3, columns = (call.width - 1) * stride_ + 3;
        pitch = std::ptrdiff_t(columns) * weights_.step();
        // The scratch holds pairs of bf16 numbers in the room of one float each.
        auto* narrow = reinterpret_cast<std::uint32_t*>(scratch);
        for (int y = 0; y < rows; ++y)
            bf16_kernels()->narrow(call.in + y * call.in_pitch, std::size_t(columns),
                                   weights_.channels(), narrow + y * pitch);
        in = narrow;
    }
    for (int y = 0; y < call.height; ++y) {
        const std::ptrdiff_t from = y * stride_ * pitch;
        const void* row =
            weights_.bf16() ? static_cast<const void*>(static_cast<const std::uint32_t*>(in) + from)
                            : static_cast<const void*>(static_cast<const float*>(in) + from);
        weights_.run(row, pitch, std::ptrdiff_t(stride_) * weights_.step(), call.width,
                     call.out + y * call.out_pitch, call.out_step);
    }
}

}  // namespace eventide
