// The fast renderer's layers, for one sample row and the pixels around it.
#include "src/kernels/vector_kernels.h"
#include "src/model/render/fast_renderer.h"

#include <algorithm>

namespace eventide {

/// What a member gives goes to `outputs`, pixel after pixel of its side's list, and from there to
/// the pixels of the row:
///
///     span of pixels 0 .. 6, side 1     outputs    j = 0   1   2
///                                       to             1   3   5     (FrameColumns::pixel)
void FastRenderer::evaluate(const Member& member, const Span& span, const Rows& to,
                            const Rows& outputs, float* scratch) const noexcept {
    const FrameColumns& columns = layout().pixels;
    const std::size_t begin = columns.tile[member.side][std::size_t(span.first)],
                      pixels = columns.tile[member.side][std::size_t(span.last)] - begin;
    if (pixels == 0) return;
    const OffsetRows offset{.sums = member.sums,
                            .ahead = member.ahead,
                            .column = columns.column[member.side].data() + begin,
                            .dx = columns.offset[member.side].data() + begin,
                            .base = member.base,
                            .slope = slope_[1].data(),
                            .pixels = int(pixels),
                            .width = first_};
    // All layers in one kernel where there is one for it; else block by block.
    if (layers_.size() != 1 || !layers_[0].run(HiddenRows{.offset = offset,
                                                          .last_weight = last_weight_.data(),
                                                          .last_bias = last_bias_.data(),
                                                          .mu = outputs.mu,
                                                          .log_sigma = outputs.log_sigma}))
        run_blocks(offset, outputs, scratch);
    add(member, begin, int(pixels), outputs, to);
}

/// So many pixels at a time that their activations stay in a core's first cache from layer to
/// layer:
///
///     scratch      numbers a pixel      written by               read by
///     activations  widest_              the first layer          the second
///     room, 1st    widest_              second, fourth ...       third, fifth ...
///     room, 2nd    widest_              third, fifth ...         fourth, sixth ...
///
/// kBlock pixels each; run_layers() swaps the two halves of `room`.
void FastRenderer::run_blocks(const OffsetRows& all, const Rows& out,
                              float* scratch) const noexcept {
    float* activations = scratch;
    float* room = activations + kBlock * widest_;
    for (int begin = 0; begin < all.pixels; begin += kBlock) {
        OffsetRows block = all;
        block.pixels = std::min(kBlock, all.pixels - begin);
        block.column += begin;
        block.dx += begin;
        block.out = activations;
        numbers_.offset_rows(block);
        const float* last = run_layers(activations, block.pixels, room);
        numbers_.kernels().two_outputs({.in = last,
                                        .weight = last_weight_.data(),
                                        .bias = last_bias_.data(),
                                        .pixels = block.pixels,
                                        .width = config_.mlp.back(),
                                        .first = out.mu + begin,
                                        .second = out.log_sigma + begin});
    }
}

void FastRenderer::add(const Member& member, std::size_t begin, int pixels, const Rows& outputs,
                       const Rows& to) const noexcept {
    const FrameColumns& columns = layout().pixels;
    numbers_.kernels().weigh_rows({.mu = outputs.mu,
                                   .log_sigma = outputs.log_sigma,
                                   .square = outputs.square,
                                   .share = columns.weight[member.side].data() + begin,
                                   .weight = member.weight,
                                   .least = config_.log_sigma_min,
                                   .most = config_.log_sigma_max,
                                   .pixels = pixels});
    const int* pixel = columns.pixel[member.side].data() + begin;
    // Where each pixel has a sample of its own, as in frames of the sensor's size, all follow each
    // other.
    const bool is_dense = pixel[pixels - 1] - pixel[0] == pixels - 1;
    const auto add_row = [&](const float* row, float* to_row) {
        float* first = to_row + pixel[0];
        if (is_dense)
            for (int j = 0; j < pixels; ++j) first[j] += row[j];
        else
            for (int j = 0; j < pixels; ++j) to_row[pixel[j]] += row[j];
    };
    add_row(outputs.mu, to.mu);
    add_row(outputs.log_sigma, to.log_sigma);
    if (outputs.square != nullptr) add_row(outputs.square, to.square);
}

/// All but the last layer's result as layers read it, the last's in float32.
const float* FastRenderer::run_layers(const float* activations, int pixels,
                                      float* room) const noexcept {
    const std::ptrdiff_t block = std::ptrdiff_t(kBlock) * widest_;
    const float* in = activations;
    float* out = room;
    for (const PackedWeights& layer : layers_) {
        const bool is_last = &layer == &layers_.back();
        // Pixels are the "outputs" of an area, each of which reads one stretch: itself.
        const Stretch stretch{in, layer.step(), 0, layer.step()};
        DotArea area;
        area.stretches = &stretch;
        area.count = 1;
        area.height = 1;
        area.width = pixels;
        area.to_bf16 = !is_last;
        area.out = out;
        area.out_step = is_last ? layer.outputs() : numbers_.units(layer.outputs());
        layer.run(area);
        in = out;
        out = out == room ? room + block : room;
    }
    if (!layers_.empty() || numbers_.bf16() == nullptr) return in;
    // No hidden layer behind the first, whose result is bf16.
    numbers_.to_float(activations, std::size_t(pixels), first_, room);
    return room;
}

}  // namespace eventide
