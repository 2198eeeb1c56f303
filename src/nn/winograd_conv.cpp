// See winograd_conv.h. A band of rows goes through scratch memory, which so stays in cache:
//
//     scratch      numbers                                read by
//     pixels v     6 planes of groups x (rows + 2) x C    products: three rows of a group
//     products m   6 planes of groups x rows x outputs    outputs; always float32
//
// To the kernel a group's rows are the pixels of a row: it reads stretches that overlap, as those
// of a convolution do.
//
//     v of a group     row 0    row 1    row 2    row 3 ...     C numbers a row
//     m of row 0       [------ length 3 C ------]
//     m of row 1                [------ length 3 C ------]      step C
//
// With bf16 numbers it is units of two of them that lie so, C / 2 a row.
#include "src/nn/winograd_conv.h"

#include "src/kernels/winograd.h"

#include <algorithm>
#include <cassert>

namespace eventide {
namespace {

constexpr int kSide = kWinogradTaps;
/// Outputs of a band, at most: more rows repeat fewer of the two that the next band reads again.
constexpr int kMaxRows = 12, kQuad = 4;

int groups_of(int width) {
    return (width + kWinogradOutputs - 1) / kWinogradOutputs;
}

/// G w: a row of three taps at a position.
double tap_sum(int position, const float* w) {
    const double a = position == 1 ? kWinogradA : -kWinogradA,
                 b = position == 3 ? kWinogradB : -kWinogradB;
    switch (position) {
        case 0:
            return w[0];
        case 1:
        case 2:
            return -2.0 / 3 * (w[0] + a * w[1] + 0.5 * w[2]);
        case 3:
        case 4:
            return 1.0 / 6 * (w[0] + b * w[1] + 2.0 * w[2]);
        default:
            return w[2];
    }
}

}  // namespace

WinogradConv::WinogradConv(const plain::ConvWeights<float>& weights,
                           const std::vector<int>& sources, bool relu, const Backend& backend)
    : inputs_(weights.in),
      outputs_(weights.out),
      sources_(sources),
      relu_(relu),
      bias_(weights.bias.begin(), weights.bias.end()) {
    assert(weights.side == kSide);
    assert(backend.bf16 == nullptr || backend.bf16->winograd_input != nullptr);
    const std::vector<float> none(weights.bias.size());
    for (int position = 0; position < kWinogradPositions; ++position) {
        const auto weight = [&](int, int row, int channel, int output) {
            const std::size_t tap = std::size_t((output * inputs_ + channel) * kSide + row) * kSide;
            return float(tap_sum(position, &weights.weight[tap]));
        };
        positions_.emplace_back(std::vector<PackedWeights::Shape>{{kSide, inputs_}}, outputs_,
                                weight, none, false, backend);
    }
}

std::size_t WinogradConv::scratch_size(int height, int width) const {
    const auto rows = std::size_t(std::min(height, kMaxRows)),
               groups = std::size_t(groups_of(width));
    return kWinogradPositions * groups *
           ((rows + kSide - 1) * std::size_t(units()) + rows * std::size_t(outputs_));
}

void WinogradConv::run(const ConvArea& area, float* scratch) const noexcept {
    // About the same size, whole quads of rows but for the last: of 50 rows 8, 12, 8, 12 and 10.
    const int quads = (area.height + kQuad - 1) / kQuad,
              bands = (area.height + kMaxRows - 1) / kMaxRows;
    const auto begin = [&](int i) { return std::min(quads * i / bands * kQuad, area.height); };
    for (int i = 0; i < bands; ++i) {
        const int y = begin(i);
        ConvArea band = area;
        band.height = begin(i + 1) - y;
        for (ConvSource& source : band.in)
            if (source.in != nullptr)
                source.in = static_cast<const float*>(source.in) + y * source.pitch;
        band.out = static_cast<float*>(area.out) + y * area.out_pitch;
        run_band(band, scratch);
    }
}

void WinogradConv::run_band(const ConvArea& band, float* scratch) const noexcept {
    const int rows = band.height, read = rows + kSide - 1, groups = groups_of(band.width);
    const std::ptrdiff_t group = std::ptrdiff_t(read) * units(), plane = groups * group,
                         products_plane = std::ptrdiff_t(groups) * rows * outputs_;
    float* products = scratch + kWinogradPositions * plane;
    sum_pixels(band, plane, scratch);
    for (int position = 0; position < kWinogradPositions; ++position) {
        const Stretch stretch{scratch + position * plane, units(), group, kSide * units()};
        DotArea dots;
        dots.stretches = &stretch;
        dots.count = 1;
        dots.height = groups;
        dots.width = rows;
        dots.out = products + position * products_plane;
        dots.out_step = outputs_;
        dots.out_pitch = std::ptrdiff_t(rows) * outputs_;
        positions_[std::size_t(position)].run(dots);
    }
    const bool to_bf16 = numbers().bf16() != nullptr && band.to_bf16;
    const WinogradOutput output{.in = products,
                                .plane = products_plane,
                                .bias = bias_.data(),
                                .relu = relu_,
                                .rows = rows,
                                .width = band.width,
                                .outputs = outputs_,
                                .out = band.out,
                                .out_pitch = band.out_pitch,
                                .out_step = to_bf16 ? numbers().units(outputs_) : outputs_};
    if (to_bf16)
        numbers().bf16()->winograd_output(output);
    else
        numbers().kernels().winograd_output(output);
}

/// The channels of all sources side by side.
void WinogradConv::sum_pixels(const ConvArea& band, std::ptrdiff_t plane,
                              float* channels) const noexcept {
    const Bf16Kernels* bf16 = numbers().bf16();
    const auto sum = bf16 != nullptr ? bf16->winograd_input : numbers().kernels().winograd_input;
    for (std::size_t i = 0; i < sources_.size(); ++i) {
        sum({.in = band.in[i].in,
             .pitch = band.in[i].pitch,
             .rows = band.height + kSide - 1,
             .pixels = band.width + kSide - 1,
             .channels = sources_[i],
             .out = channels,
             .plane = plane,
             .step = units()});
        channels += numbers().units(sources_[i]);
    }
}

}  // namespace eventide
