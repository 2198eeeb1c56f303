// The fast convolutions: packing, and whose kernels they call.
#include "src/nn/packed_conv.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#include <numeric>
#include <utility>

namespace eventide {

namespace {

/// Fewer channels cost more in sums than they save in products, which are cheaper in bf16.
bool pays_by_winograd(const plain::ConvWeights<float>& weights, int stride,
                      const std::vector<int>& sources, const Backend& backend) {
    if (backend.onednn || stride != 1 || weights.side != 3) return false;
    if (backend.bf16 == nullptr) {
        constexpr int kLeast = 4;
        return weights.in >= kLeast && weights.out >= kLeast;
    }
    constexpr int kLeastWeights = 512;  // of a tap
    const auto is_even = [](int channels) { return channels % 2 == 0; };
    return backend.bf16->winograd_input != nullptr && weights.in * weights.out >= kLeastWeights &&
           is_even(weights.out) && std::ranges::all_of(sources, is_even);
}

}  // namespace

PackedConv::PackedConv(const plain::ConvWeights<float>& weights, int stride, bool relu,
                       const Backend& backend, std::vector<Extent> extents,
                       std::vector<int> sources, Summation summation)
    : stride_(stride),
      side_(weights.side),
      inputs_(weights.in),
      outputs_(weights.out),
      sources_(std::move(sources)),
      as_one_(summation == Summation::as_one),
      numbers_(backend) {
    if (sources_.empty()) sources_ = {weights.in};
    assert(std::accumulate(sources_.begin(), sources_.end(), 0) == weights.in);
    assert(sources_.size() <= ConvArea::kMaxSources);
    assert(!as_one_ || sources_.size() == 1 || !backend.onednn);
    if (backend.onednn && side_ == 3) {
        onednn_ = std::make_shared<const OnednnConv>(weights, stride, relu, backend.bf16,
                                                     std::move(extents));
        return;
    }
    if (summation != Summation::by_pixel && pays_by_winograd(weights, stride, sources_, backend)) {
        winograd_ = std::make_shared<const WinogradConv>(weights, sources_, relu, backend);
        return;
    }
    single_ = packed(weights, 1, relu, backend);
    const int lanes = backend.bf16 != nullptr ? kBf16Lanes : backend.f32->lanes;
    const bool is_whole = backend.bf16 == nullptr || outputs_ % 2 == 0;
    if (!by_quads() && !as_one_ && side_ > 1 && 2 * outputs_ <= lanes && is_whole)
        pair_ = packed(weights, 2, relu, backend);
}

bool PackedConv::by_quads() const {
    constexpr int kQuad = 4;
    return numbers().by_quads() && stride_ == 1 && (outputs_ == 8 || outputs_ == 16) &&
           std::ranges::all_of(sources_, [&](int c) { return numbers().units(c) % kQuad == 0; });
}

/// body(source, row, first column) of each of the stretches that an output reads, in the order in
/// which they are summed up.
///
///     sources a, b, side 3       a: row 0 | row 1 | row 2    b: row 0 | row 1 | row 2
///     as_one                     row 0: a0 b0 | a1 b1 | a2 b2    row 1: a0 b0 | ...
///
/// The second is the order in which a map that has the channels of both is summed up: the bits are
/// the same.
template <typename Body>
void PackedConv::over_stretches(const Body& body) const {
    const int sources = int(sources_.size());
    if (as_one_) {
        for (int row = 0; row < side_; ++row)
            for (int x = 0; x < side_; ++x)
                for (int i = 0; i < sources; ++i) body(i, row, x);
    } else {
        for (int i = 0; i < sources; ++i)
            for (int row = 0; row < side_; ++row) body(i, row, 0);
    }
}

/// Weights for so many pixels of output beside each other, which read the same stretches:
///
///     pixels read    0   1   2   3        side 3, stride 1
///     output 0       w0  w1  w2  0
///     output 1       0   w0  w1  w2
PackedWeights PackedConv::packed(const plain::ConvWeights<float>& weights, int pixels, bool relu,
                                 const Backend& backend) const {
    struct Place {
        int channel, row, x;  // where a stretch begins
    };
    std::vector<PackedWeights::Shape> stretches;
    std::vector<Place> places;
    over_stretches([&](int source, int row, int x) {
        const auto begin = sources_.begin();
        stretches.push_back({as_one_ ? 1 : side_ + (pixels - 1) * stride_, begin[source]});
        places.push_back({std::accumulate(begin, begin + source, 0), row, x});
    });
    const auto weight = [&](int s, int at, int c, int o) {
        const auto& [channel, y, first] = places[std::size_t(s)];
        // The tap at which its output sees this pixel: the second output's begin `stride_` later.
        const int x = first + at - o / outputs_ * stride_;
        if (x < 0 || x >= side_) return 0.0F;
        const int tap = (o % outputs_ * inputs_ + channel + c) * side_ * side_ + y * side_ + x;
        return weights.weight[std::size_t(tap)];
    };
    std::vector<float> bias;
    for (int p = 0; p < pixels; ++p)
        bias.insert(bias.end(), weights.bias.begin(), weights.bias.end());
    return {stretches, pixels * outputs_, weight, bias, relu, backend};
}

std::size_t PackedConv::scratch_size(int height, int width) const {
    const std::size_t area = std::size_t(reach(height)) * std::size_t(reach(width));
    if (onednn_ != nullptr)
        return onednn_->scratch_size() + area * std::size_t(inputs_) +
               std::size_t(height) * std::size_t(width) * std::size_t(outputs_);
    const std::size_t converted =
        numbers().bf16() != nullptr ? area * std::size_t(numbers().units(inputs_)) : 0;
    return converted + (winograd_ != nullptr ? winograd_->scratch_size(height, width) : 0);
}

void PackedConv::run(const ConvArea& area, float* scratch) const noexcept {
    if (onednn_ != nullptr)
        run_onednn(area, scratch);
    else
        run_own(area, scratch);
}

void PackedConv::run(const ConvCall& call, float* scratch) const noexcept {
    if (onednn_ != nullptr) {
        onednn_->run(call, scratch);
        return;
    }
    ConvArea area{.in = {{{call.in, call.in_pitch}}},
                  .out = call.out,
                  .out_pitch = call.out_pitch,
                  .height = call.height,
                  .width = call.width};
    if (numbers().bf16() != nullptr) {
        const int rows = reach(call.height), columns = reach(call.width);
        const std::ptrdiff_t pitch = std::ptrdiff_t(columns) * numbers().units(inputs_);
        // Units of two numbers take the room of one float.
        for (int y = 0; y < rows; ++y)
            numbers().from_float(call.in + y * call.in_pitch, std::size_t(columns), inputs_,
                                 scratch + y * pitch);
        area.in[0] = {scratch, pitch};
        scratch += rows * pitch;
    }
    run_own(area, scratch);
}

/// Pairs of outputs where there are weights for them. A row of 5:
///
///     outputs    0 1 | 2 3 |
///                          3 4
void PackedConv::run_own(const ConvArea& area, float* scratch) const noexcept {
    if (winograd_ != nullptr) {
        winograd_->run(area, scratch);
        return;
    }
    if (pair_.empty() || area.width < 2) {
        run_part(area, 0, area.width, 1);
        return;
    }
    run_part(area, 0, area.width / 2, 2);
    // Of an odd number the last two, again: one of them is written twice, with the same bits.
    if (area.width % 2 != 0) run_part(area, area.width - 2, 1, 2);
}

/// `count` times one or two outputs of each row, from `first` on.
void PackedConv::run_part(const ConvArea& area, int first, int count, int at_once) const noexcept {
    std::array<Stretch, std::size_t{9} * ConvArea::kMaxSources> stretches;
    int n = 0;
    over_stretches([&](int source, int row, int x) {
        const auto [in, pitch] = area.in[std::size_t(source)];
        const int units = numbers().units(sources_[std::size_t(source)]);
        const std::ptrdiff_t step = std::ptrdiff_t(stride_) * units;
        stretches[std::size_t(n++)] = {
            static_cast<const float*>(in) + row * pitch + first * step + std::ptrdiff_t(x) * units,
            at_once * step, stride_ * pitch,
            as_one_ ? units : (side_ + (at_once - 1) * stride_) * units};
    });
    const std::ptrdiff_t out_step = area.to_bf16 ? numbers().units(outputs_) : outputs_;
    DotArea dots;
    dots.stretches = stretches.data();
    dots.count = n;
    dots.height = area.height;
    dots.width = count;
    dots.to_bf16 = area.to_bf16;
    dots.out = static_cast<float*>(area.out) + first * out_step;
    dots.out_step = at_once * out_step;
    dots.out_pitch = area.out_pitch;
    (at_once == 2 ? pair_ : single_).run(dots);
}

/// Scratch: the sources joined pixel by pixel, then outputs that are still to become bf16, then
/// oneDNN's.
void PackedConv::run_onednn(const ConvArea& area, float* scratch) const noexcept {
    gather(area, scratch);
    float* wide = scratch + std::ptrdiff_t(reach(area.height)) * reach(area.width) * inputs_;
    float* rest = wide + std::ptrdiff_t(area.height) * area.width * outputs_;
    ConvCall call;
    call.gathered = scratch;
    call.out = area.to_bf16 ? wide : static_cast<float*>(area.out);
    call.out_pitch = area.to_bf16 ? std::ptrdiff_t(area.width) * outputs_ : area.out_pitch;
    call.height = area.height;
    call.width = area.width;
    onednn_->run(call, rest);
    if (!area.to_bf16) return;
    for (int y = 0; y < area.height; ++y)
        numbers().from_float(wide + y * call.out_pitch, std::size_t(area.width), outputs_,
                             static_cast<float*>(area.out) + y * area.out_pitch);
}

/// The sources' channels side by side, [reach][reach][inputs_], without the zeros beside the last
/// of an odd number.
void PackedConv::gather(const ConvArea& area, void* dense) const noexcept {
    const std::size_t size = numbers().bf16() != nullptr ? sizeof(std::uint16_t) : sizeof(float);
    auto* to = static_cast<std::byte*>(dense);
    for (int y = 0; y < reach(area.height); ++y)
        for (int x = 0; x < reach(area.width); ++x)
            for (std::size_t i = 0; i < sources_.size(); ++i) {
                const auto bytes = std::size_t(sources_[i]) * size;
                std::memcpy(to,
                            static_cast<const float*>(area.in[i].in) + y * area.in[i].pitch +
                                std::ptrdiff_t(x) * numbers().units(sources_[i]),
                            bytes);
                to += bytes;
            }
}

}  // namespace eventide
