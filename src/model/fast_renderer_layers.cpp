// The fast renderer's layers, for one sample row and the pixels around it.
#include "src/kernels/vector_kernels.h"
#include "src/model/fast_renderer.h"

#include <algorithm>

namespace eventide {

void FastRenderer::evaluate(const Member& member, const Span& span, float* blended, int width,
                            float* scratch) const noexcept {
    const FrameColumns& columns = layout_.pixels;
    const std::size_t begin = columns.tile[member.side][std::size_t(span.first)],
                      pixels = columns.tile[member.side][std::size_t(span.last)] - begin;
    if (pixels == 0) return;
    float* mu = blended + 3 * width;
    const Outputs out{mu, mu + width, needs_squares_ ? mu + 2 * width : nullptr};
    const OffsetRows offset{member.sums,
                            member.ahead,
                            columns.column[member.side].data() + begin,
                            columns.offset[member.side].data() + begin,
                            member.base,
                            slope_[1].data(),
                            int(pixels),
                            first_,
                            nullptr};
    if (layers_.size() != 1 || !layers_[0].run({offset, nullptr, nullptr, 0, last_weight_.data(),
                                                last_bias_.data(), out.mu, out.log_sigma}))
        run_blocks(offset, out, scratch);
    add(member, begin, int(pixels), out, blended, width);
}

void FastRenderer::run_blocks(const OffsetRows& all, const Outputs& out,
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
        vector_kernels().two_outputs({last, last_weight_.data(), last_bias_.data(), block.pixels,
                                      config_.mlp.back(), out.mu + begin, out.log_sigma + begin});
    }
}

void FastRenderer::add(const Member& member, std::size_t begin, int pixels, const Outputs& outputs,
                       float* blended, int width) const noexcept {
    const FrameColumns& columns = layout_.pixels;
    vector_kernels().weigh_rows({outputs.mu, outputs.log_sigma, outputs.square,
                                 columns.weight[member.side].data() + begin, member.weight,
                                 config_.log_sigma_min, config_.log_sigma_max, pixels});
    const int* pixel = columns.pixel[member.side].data() + begin;
    const float* const parts[] = {outputs.mu, outputs.log_sigma, outputs.square};
    for (const float* part : parts) {
        if (part != nullptr)
            for (int j = 0; j < pixels; ++j) blended[pixel[j]] += part[j];
        blended += width;
    }
}

/// All but the last layer's result as layers read it, the last's in float32.
const float* FastRenderer::run_layers(const float* activations, int pixels,
                                      float* room) const noexcept {
    const std::ptrdiff_t block = std::ptrdiff_t(kBlock) * widest_;
    const float* in = activations;
    float* out = room;
    for (const PackedWeights& layer : layers_) {
        const bool is_last = &layer == &layers_.back();
        const Stretch stretch{in, layer.step(), 0, layer.step()};
        DotArea area;
        area.stretches = &stretch;
        area.count = 1;
        area.height = 1;
        area.width = pixels;
        area.narrow = !is_last;
        area.out = out;
        area.out_step = is_last ? layer.outputs() : numbers_.units(layer.outputs());
        layer.run(area);
        in = out;
        out = out == room ? room + block : room;
    }
    if (!layers_.empty() || numbers_.bf16() == nullptr) return in;
    numbers_.widen(activations, std::size_t(pixels), first_, room);
    return room;
}

}  // namespace eventide
