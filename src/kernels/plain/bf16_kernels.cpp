// The plain kernels of bf16_kernels.h.
#include "src/kernels/bf16_kernels.h"
#include "src/kernels/pixels_to_bf16.h"
#include "src/kernels/plain/activations.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace eventide::plain {
namespace {

/// The two numbers of a pair, low half first.
float first_of(std::uint32_t pair) {
    return std::bit_cast<float>(pair << 16);
}
float second_of(std::uint32_t pair) {
    return std::bit_cast<float>(pair & 0xffff'0000U);
}

using Block = std::array<float, 2 * std::size_t{kBf16Lanes}>;

/// A product of two bf16 numbers is exact in float32, so only the sums round.
/// Returns where the next block's weights are.
const std::uint32_t* sum_block(const DotArea& r, int y, int x, int width,
                               const std::uint32_t* weight, Block& sums) {
    for (int s = 0; s < r.count; ++s) {
        const Stretch& stretch = r.stretches[s];
        const auto* in =
            static_cast<const std::uint32_t*>(stretch.in) + y * stretch.pitch + x * stretch.step;
        for (int k = 0; k < stretch.length; ++k, weight += width) {
            const float a = first_of(in[k]), b = second_of(in[k]);
            for (std::size_t o = 0; o < std::size_t(width); ++o)
                sums[o] = (sums[o] + b * second_of(weight[o])) + a * first_of(weight[o]);
        }
    }
    return weight;
}

void dot_pixel(const DotArea& r, int y, int x) {
    const int lanes = bf16_lanes(r.outputs);
    const std::ptrdiff_t at = y * r.out_pitch + x * r.out_step;
    const auto* weight = static_cast<const std::uint32_t*>(r.weight);
    for (int first = 0; first < r.outputs;) {
        const int width = r.outputs - first > lanes ? 2 * lanes : lanes;
        Block sums{};
        std::copy_n(r.bias + first, width, sums.begin());
        weight = sum_block(r, y, x, width, weight, sums);
        const int stored = r.to_bf16 ? (r.outputs + 1) / 2 * 2 : r.outputs;
        for (int o = 0; o < std::min(width, stored - first); ++o) {
            const float sum = sums[std::size_t(o)], value = r.relu ? std::max(sum, 0.0F) : sum;
            if (r.to_bf16)
                static_cast<std::uint16_t*>(r.out)[2 * at + first + o] = to_bf16(value);
            else
                static_cast<float*>(r.out)[at + first + o] = value;
        }
        first += width;
    }
}

void dot_area(const DotArea& r) {
    for (int y = 0; y < r.height; ++y)
        for (int x = 0; x < r.width; ++x) dot_pixel(r, y, x);
}

void row_to_bf16(const float* in, std::size_t n, std::uint16_t* out) {
    std::transform(in, in + n, out, to_bf16);
}
void pixels_to_bf16(const float* in, std::size_t pixels, int channels, std::uint32_t* out) {
    convert_pixels(row_to_bf16, in, pixels, channels, out);
}

void compress_row(const CompressRow& r) {
    const std::ptrdiff_t step = r.size;
    for (int p = 0; p < r.pixels; ++p)
        for (int c = 0; c < r.size * r.maps; ++c) {
            auto* map = static_cast<std::uint16_t*>(r.out) + 2 * (c / r.size) * r.plane;
            const float value =
                c < r.channels ? compress(r.in[std::ptrdiff_t{p} * r.channels + c]) : 0.0F;
            map[p * step + c % r.size] = to_bf16(value);
        }
}
void keep_row(const KeepRow& r) {
    const std::ptrdiff_t step = (r.channels + 1) / 2 * 2;
    for (int p = 0; p < r.pixels; ++p)
        for (std::ptrdiff_t c = 0; c < step; ++c)
            r.kept[p * step + c] =
                c < r.channels
                    ? to_bf16(sigmoid(r.r[p * r.r_step + c]) * from_bf16(r.h[p * step + c]))
                    : std::uint16_t{0};
}
void update_row(const UpdateRow& r) {
    const std::ptrdiff_t step = (r.channels + 1) / 2 * 2;
    for (int p = 0; p < r.pixels; ++p)
        for (std::ptrdiff_t c = 0; c < step; ++c) {
            std::uint16_t& rounded = r.rounded[p * step + c];
            rounded = 0;
            if (c == r.channels) continue;
            const float v = r.v[p * r.v_step + c];
            float& h = r.h[std::ptrdiff_t{p} * r.channels + c];
            h += sigmoid(r.u[p * r.u_step + c]) * (std::tanh(r.is_doubled ? v / 2 : v) - h);
            rounded = to_bf16(h);
        }
}

void double_row(const DoubleRow& r) {
    const auto *above = static_cast<const std::uint16_t*>(r.above),
               *under = static_cast<const std::uint16_t*>(r.under);
    auto* out = static_cast<std::uint16_t*>(r.out);
    const auto n = std::ptrdiff_t(r.channels);
    for (int x = r.x0; x < r.x1; ++x, out += n) {
        const std::ptrdiff_t left = x / 2 * n, right = std::min((x + 1) / 2, r.last) * n;
        for (std::ptrdiff_t c = 0; c < n; ++c)
            out[c] = to_bf16(((from_bf16(above[left + c]) + from_bf16(under[left + c])) +
                              (from_bf16(above[right + c]) + from_bf16(under[right + c]))) *
                             0.25F);
    }
}

void offset_rows(const OffsetRows& r) {
    const std::ptrdiff_t width = r.width, step = (width + 1) / 2 * 2;
    for (int p = 0; p < r.pixels; ++p) {
        const std::uint16_t* sums = static_cast<const std::uint16_t*>(r.sums) + r.column[p] * step;
        auto* out = static_cast<std::uint16_t*>(r.out) + p * step;
        for (std::ptrdiff_t c = 0; c < width; ++c)
            out[c] =
                to_bf16(std::max(from_bf16(sums[c]) + (r.base[c] + r.dx[p] * r.slope[c]), 0.0F));
        if (step > width) out[width] = 0;
    }
}

}  // namespace

const Bf16Kernels& bf16_kernels() {
    static const Bf16Kernels kKernels{.name = "emulated",
                                      .dot_area = dot_area,
                                      .pixels_to_bf16 = pixels_to_bf16,
                                      .row_to_bf16 = row_to_bf16,
                                      .compress_row = compress_row,
                                      .keep_row = keep_row,
                                      .update_row = update_row,
                                      .double_row = double_row,
                                      .offset_rows = offset_rows,
                                      .hidden_rows = nullptr};
    return kKernels;
}

}  // namespace eventide::plain
