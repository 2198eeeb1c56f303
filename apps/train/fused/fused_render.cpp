// The renderer behind its first convolution as one function of autograd's: nothing of what lies
// between samples and outputs is kept, it is computed again on the way back.
#include "apps/train/fused/fused.h"
#include "apps/train/fused/fused_render_types.h"
#include "apps/train/fused/fused_types.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>

namespace eventide::fused {

namespace any_processor {
constexpr int kVectorBytes = 16, kRegisters = 16;
#include "apps/train/fused/fused_render_loops.inl"
}  // namespace any_processor

// GCC 13 no longer inlines what the standard library says is always inline (std::array::data) where
// a pragma chose the instruction set, and stops.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && __GNUC__ < 13
#define EVENTIDE_WIDER_LOOPS 1
#pragma GCC push_options
#pragma GCC target("arch=haswell")
namespace avx2 {
constexpr int kVectorBytes = 32, kRegisters = 16;
#include "apps/train/fused/fused_render_loops.inl"
}  // namespace avx2
#pragma GCC pop_options
#pragma GCC push_options
#pragma GCC target("arch=skylake-avx512,prefer-vector-width=512")
namespace avx512 {
constexpr int kVectorBytes = 64, kRegisters = 32;
#include "apps/train/fused/fused_render_loops.inl"
}  // namespace avx512
#pragma GCC pop_options
#endif

namespace {

/// The widest loops that this processor has.
template <int H, typename T, typename W>
struct Loops {
    decltype(&any_processor::render_forward<H, T, W>) forward;
    decltype(&any_processor::render_backward<H, T, W>) backward;

    static Loops best() {
#ifdef EVENTIDE_WIDER_LOOPS
        if (__builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl"))
            return {avx512::render_forward<H, T, W>, avx512::render_backward<H, T, W>};
        if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
            return {avx2::render_forward<H, T, W>, avx2::render_backward<H, T, W>};
#endif
        return {any_processor::render_forward<H, T, W>, any_processor::render_backward<H, T, W>};
    }
};

using torch::autograd::AutogradContext;
using torch::autograd::variable_list;

constexpr std::int64_t kWidths[] = {16, 32, 64};

template <typename Work>
void for_width(std::int64_t width, const Work& work) {
    if (width == 16) work(std::integral_constant<int, 16>{});
    if (width == 32) work(std::integral_constant<int, 32>{});
    if (width == 64) work(std::integral_constant<int, 64>{});
}

/// Inputs in the order autograd gets them.
enum Input { kMap, kOffsets, kHidden, kHiddenBias, kLast, kLastBias, kInputs };

template <typename W>
std::vector<W> numbers(const torch::Tensor& x) {
    const torch::Tensor flat = x.detach().to(wide_of(x.scalar_type())).contiguous();
    return {flat.data_ptr<W>(), flat.data_ptr<W>() + flat.numel()};
}

template <int H, typename W>
RenderWeights<H, W> weights_of(const variable_list& in, const MemberBlend& blend) {
    RenderWeights<H, W> w;
    const auto offsets = numbers<W>(in[kOffsets]), hidden = numbers<W>(in[kHidden]),
               bias = numbers<W>(in[kHiddenBias]), last = numbers<W>(in[kLast]),
               last_bias = numbers<W>(in[kLastBias]);
    for (std::size_t k = 0; k < H; ++k)
        for (std::size_t d = 0; d < 3; ++d) w.offset[d * H + k] = offsets[k * 3 + d];
    std::ranges::copy(hidden, w.turned.begin());  // [out][in]
    for (std::size_t o = 0; o < H; ++o)
        for (std::size_t i = 0; i < H; ++i) w.hidden[i * H + o] = hidden[o * H + i];
    std::ranges::copy(bias, w.hidden_bias.begin());
    std::ranges::copy(last, w.last.begin());
    std::ranges::copy(last_bias, w.last_bias.begin());
    w.low = W(blend.log_sigma_min);
    w.high = W(blend.log_sigma_max);
    w.squares = blend.squares;
    return w;
}

/// Calls use(block, m, number of the block's first point among the m-th image's) for all blocks.
template <typename W, typename Use>
void for_each_block(const torch::Tensor& map, const MemberBlend& blend, const Use& use) {
    const std::int64_t H = map.size(1), h = map.size(2), w = map.size(3);
    const auto columns = std::int64_t(blend.x[0].index.size());
    PointBlock<W> block;
    for (std::int64_t m = 0; m < map.size(0); ++m)
        for (std::size_t row = 0; row < blend.y[0].index.size(); ++row)
            for (std::size_t n = 0; n < 4; ++n) {
                const auto &y = blend.y[n / 2], &x = blend.x[n % 2];
                const W row_weight = W(blend.weight[std::size_t(m)] * y.weight[row]);
                if (row_weight == 0) continue;
                block.dt = W(blend.dt[std::size_t(m)]);
                block.dy = W(y.offset[row]);
                for (std::int64_t begin = 0; begin < columns; begin += kPoints) {
                    block.count = int(std::min<std::int64_t>(kPoints, columns - begin));
                    bool any = false;
                    for (int p = 0; p < block.count; ++p) {
                        const auto i = std::size_t(p), c = std::size_t(begin) + i;
                        block.sample[i] = ((m * h + y.index[row]) * w + x.index[c]) * H;
                        block.dx[i] = W(x.offset[c]);
                        block.weight[i] = row_weight * W(x.weight[c]);
                        any |= x.weight[c] != 0;
                    }
                    if (any) use(block, m, std::int64_t(row) * columns + begin);
                }
            }
}

struct Members : torch::autograd::Function<Members> {
    static torch::Tensor forward(AutogradContext* ctx, const torch::Tensor& map_in,
                                 const torch::Tensor& offsets, const torch::Tensor& hidden,
                                 const torch::Tensor& hidden_bias, const torch::Tensor& last,
                                 const torch::Tensor& last_bias,
                                 const c10::intrusive_ptr<MemberBlend>& blend) {
        const variable_list in{packed(map_in), offsets, hidden, hidden_bias, last, last_bias};
        ctx->save_for_backward(in);
        ctx->saved_data["blend"] = torch::IValue::make_capsule(blend);
        const torch::Tensor& map = in[kMap];
        const auto rows = std::int64_t(blend->y[0].index.size()),
                   columns = std::int64_t(blend->x[0].index.size());
        torch::Tensor out = torch::zeros({map.size(0), 2, rows, columns},
                                         map.options().dtype(wide_of(map.scalar_type())));
        for_type(map.scalar_type(), [&]<typename T, typename W>(T, W) {
            for_width(map.size(1), [&](auto width) {
                constexpr int H = decltype(width)::value;
                const auto w = weights_of<H, W>(in, *blend);
                const auto room = std::make_unique<PointRoom<H, W>>();
                const auto loops = Loops<H, T, W>::best();
                for_each_block<W>(map, *blend, [&](const auto& block, std::int64_t m, auto at) {
                    W* to = out.data_ptr<W>() + m * 2 * rows * columns + at;
                    loops.forward(w, block, map.data_ptr<T>(), *room, to, to + rows * columns);
                });
            });
        });
        return out;
    }
    static variable_list backward(AutogradContext* ctx, const variable_list& grads) {
        const variable_list in = ctx->get_saved_variables();
        const torch::Tensor &map = in[kMap], g = grads[0].contiguous();
        const auto held = ctx->saved_data["blend"].toCapsule();
        const auto& blend = static_cast<const MemberBlend&>(*held);
        const std::int64_t points = g.size(2) * g.size(3);
        variable_list out(kInputs + 1);
        for_type(map.scalar_type(), [&]<typename T, typename W>(T, W) {
            for_width(map.size(1), [&](auto width) {
                constexpr int H = decltype(width)::value;
                const auto w = weights_of<H, W>(in, blend);
                const auto room = std::make_unique<PointRoom<H, W>>();
                const auto loops = Loops<H, T, W>::best();
                const auto sums = std::make_unique<RenderGradients<H, W>>();
                torch::Tensor g_map =
                    torch::zeros_like(map, map.options().dtype(wide_of(map.scalar_type())));
                for_each_block<W>(map, blend, [&](const auto& block, std::int64_t m, auto at) {
                    const W* from = g.data_ptr<W>() + m * 2 * points + at;
                    loops.backward(w, block, map.data_ptr<T>(), from, from + points, *room,
                                   g_map.data_ptr<W>(), *sums);
                });
                const auto tensor = [&](const auto& values, at::IntArrayRef shape) {
                    return torch::from_blob(const_cast<W*>(values.data()), shape, g.options())
                        .clone();
                };
                const auto like = [&](const torch::Tensor& x, Input i) {
                    return x.to(in[i].scalar_type());
                };
                out[kMap] = like(g_map, kMap);
                out[kOffsets] = like(tensor(sums->offset, {3, H}).t(), kOffsets);
                out[kHidden] = like(tensor(sums->hidden, {H, H}).t(), kHidden);
                out[kHiddenBias] = like(tensor(sums->hidden_bias, {H}), kHiddenBias);
                out[kLast] = like(tensor(sums->last, {2, H}), kLast);
                out[kLastBias] = like(tensor(sums->last_bias, {2}), kLastBias);
            });
        });
        return out;
    }
};

}  // namespace

bool members_fused(const torch::Tensor& first, const std::vector<torch::Tensor>& weights) {
    return first.is_cpu() && weights.size() == 3 && weights[1].size(0) == weights[1].size(1) &&
           std::ranges::count(kWidths, weights[1].size(0)) == 1;
}

torch::Tensor members(const torch::Tensor& first, const torch::Tensor& offsets,
                      const std::vector<torch::Tensor>& weights,
                      const std::vector<torch::Tensor>& biases,
                      const c10::intrusive_ptr<MemberBlend>& blend) {
    return Members::apply(first, offsets, weights[1], biases[1], weights[2], biases[2], blend);
}

}  // namespace eventide::fused
