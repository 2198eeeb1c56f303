// Doubling and the renderer's first layer as functions of autograd's around their loops.
#include "apps/train/fused/fused.h"
#include "apps/train/fused/fused_loops.h"
#include "apps/train/fused/fused_types.h"

#include <cmath>

#include <algorithm>

namespace eventide::fused {
namespace {

using torch::autograd::AutogradContext;
using torch::autograd::variable_list;

/// The four sources of pixel (y, x) of up2, as offsets in pixels within one image.
struct Sources {
    Sources(std::int64_t y, std::int64_t x, std::int64_t h, std::int64_t w) {
        const std::int64_t y0 = y / 2, x0 = x / 2;
        const std::int64_t y1 = std::min(y0 + y % 2, h - 1), x1 = std::min(x0 + x % 2, w - 1);
        at[0] = y0 * w + x0;
        at[1] = y0 * w + x1;
        at[2] = y1 * w + x0;
        at[3] = y1 * w + x1;
    }
    std::int64_t at[4];
};

template <typename Visit>
void for_pixels(const torch::Tensor& a, std::int64_t height, std::int64_t width,
                const Visit& visit) {
    const std::int64_t h = a.size(2), w = a.size(3);
    for (std::int64_t n = 0, p = 0; n < a.size(0); ++n)
        for (std::int64_t y = 0; y < height; ++y)
            for (std::int64_t x = 0; x < width; ++x, ++p) visit(n * h * w, p, Sources{y, x, h, w});
}

struct Up2 : torch::autograd::Function<Up2> {
    static torch::Tensor forward(AutogradContext* ctx, const torch::Tensor& a_in,
                                 std::int64_t height, std::int64_t width) {
        const torch::Tensor a = packed(a_in);
        ctx->saved_data["height"] = a.size(2);
        ctx->saved_data["width"] = a.size(3);
        const std::int64_t C = a.size(1);
        const torch::Tensor out = torch::empty({a.size(0), C, height, width}, a.options(),
                                               c10::MemoryFormat::ChannelsLast);
        for_type(a.scalar_type(), [&]<typename T, typename W>(T, W) {
            const T* in = a.data_ptr<T>();
            T* to = out.data_ptr<T>();
            for_pixels(a, height, width, [&](std::int64_t base, std::int64_t p, const Sources& s) {
                const auto from = [&](int i) { return in + (base + s.at[i]) * C; };
                mean4<T, W>(C, from(0), from(1), from(2), from(3), to + p * C);
            });
        });
        return out;
    }
    static variable_list backward(AutogradContext* ctx, const variable_list& grads) {
        const torch::Tensor g = packed(grads[0]);
        const std::int64_t C = g.size(1);
        torch::Tensor sum = torch::zeros(
            {g.size(0), ctx->saved_data["height"].toInt(), ctx->saved_data["width"].toInt(), C},
            g.options().dtype(wide_of(g.scalar_type())));
        sum = sum.permute({0, 3, 1, 2});
        for_type(g.scalar_type(), [&]<typename T, typename W>(T, W) {
            const T* in = g.data_ptr<T>();
            W* to = sum.data_ptr<W>();
            for_pixels(sum, g.size(2), g.size(3),
                       [&](std::int64_t base, std::int64_t p, const Sources& s) {
                           for (const std::int64_t at : s.at)
                               add_quarter<T, W>(C, in + p * C, to + (base + at) * C);
                       });
        });
        return {sum.to(g.scalar_type()), torch::Tensor{}, torch::Tensor{}};
    }
};

struct Offset : torch::autograd::Function<Offset> {
    static torch::Tensor forward(AutogradContext* ctx, const torch::Tensor& first_in,
                                 const torch::Tensor& dt, const torch::Tensor& offsets,
                                 const Axis& y, const Axis& x) {
        const torch::Tensor first = packed(first_in);
        const auto rows = std::int64_t(y.index.size()), columns = std::int64_t(x.index.size());
        const std::int64_t M = first.size(0), H = first.size(1), w = first.size(3);
        const torch::Tensor out =
            torch::empty({M, H, rows, columns}, first.options(), torch::MemoryFormat::ChannelsLast);
        const torch::Tensor wide = offsets.t().to(wide_of(first.scalar_type())).contiguous();
        for_type(first.scalar_type(), [&]<typename T, typename W>(T, W) {
            const W *o = wide.data_ptr<W>(), *t = dt.data_ptr<W>();
            std::vector<W> row(std::size_t(H), W(0));
            T* to = out.data_ptr<T>();
            for (std::int64_t m = 0; m < M; ++m)
                for (std::size_t r = 0; r < y.index.size(); ++r) {
                    for (std::int64_t k = 0; k < H; ++k)
                        row[std::size_t(k)] = t[m] * o[k] + W(y.offset[r]) * o[2 * H + k];
                    const T* from = first.data_ptr<T>() + (m * first.size(2) + y.index[r]) * w * H;
                    for (std::size_t c = 0; c < x.index.size(); ++c, to += H)
                        offset_point<T, W>(H, from + x.index[c] * H, row.data(), o + H,
                                           W(x.offset[c]), to);
                }
        });
        ctx->save_for_backward({out, dt});
        ctx->saved_data["h"] = first.size(2);
        ctx->saved_data["w"] = w;
        ctx->saved_data["y"] = y.index;
        ctx->saved_data["x"] = x.index;
        ctx->saved_data["dy"] = y.offset;
        ctx->saved_data["dx"] = x.offset;
        return out;
    }
    static variable_list backward(AutogradContext* ctx, const variable_list& grads) {
        const auto saved = ctx->get_saved_variables();
        const torch::Tensor &out = saved[0], &dt = saved[1], g = packed(grads[0]);
        const Axis y{ctx->saved_data["y"].toIntVector(), ctx->saved_data["dy"].toDoubleVector()};
        const Axis x{ctx->saved_data["x"].toIntVector(), ctx->saved_data["dx"].toDoubleVector()};
        const std::int64_t M = out.size(0), H = out.size(1), h = ctx->saved_data["h"].toInt(),
                           w = ctx->saved_data["w"].toInt();
        const auto wide = out.options().dtype(wide_of(out.scalar_type()));
        const torch::Tensor g_first = torch::zeros({M, h, w, H}, wide);
        const torch::Tensor g_offsets = torch::zeros({3, H}, wide);
        for_type(out.scalar_type(), [&]<typename T, typename W>(T, W) {
            const W* t = dt.data_ptr<W>();
            W* go = g_offsets.data_ptr<W>();
            const T *value = out.data_ptr<T>(), *from = g.data_ptr<T>();
            std::vector<W> sum(std::size_t(H), W(0));
            for (std::int64_t m = 0; m < M; ++m)
                for (std::size_t r = 0; r < y.index.size(); ++r) {
                    std::fill(sum.begin(), sum.end(), W(0));
                    W* to = g_first.data_ptr<W>() + (m * h + y.index[r]) * w * H;
                    for (std::size_t c = 0; c < x.index.size(); ++c, value += H, from += H)
                        offset_point_backward<T, W>(H, value, from, W(x.offset[c]),
                                                    to + x.index[c] * H, sum.data(), go + H);
                    for (std::int64_t k = 0; k < H; ++k) {
                        go[k] += t[m] * sum[std::size_t(k)];
                        go[2 * H + k] += W(y.offset[r]) * sum[std::size_t(k)];
                    }
                }
        });
        const auto type = out.scalar_type();
        return {g_first.permute({0, 3, 1, 2}).to(type), torch::Tensor{}, g_offsets.t().to(type),
                torch::Tensor{}, torch::Tensor{}};
    }
};

}  // namespace

torch::Tensor compressed(const torch::Tensor& grid_in, torch::ScalarType type) {
    if (!grid_in.is_cpu()) return composed::compressed(grid_in, type);
    const torch::Tensor grid = packed(grid_in.to(wide_of(type)));
    torch::Tensor out = torch::zeros_like(grid, grid.options().dtype(type));
    for_type(type, [&]<typename T, typename W>(T, W) {
        const W* from = grid.data_ptr<W>();
        T* to = out.data_ptr<T>();
        // Most numbers are 0, as most pixels have no events.
        for (std::int64_t i = 0; i < grid.numel(); ++i)
            if (const W v = from[i]; v != 0) to[i] = T(std::copysign(std::log1p(std::abs(v)), v));
    });
    return out;
}

torch::Tensor up2(const torch::Tensor& a, std::int64_t height, std::int64_t width) {
    return a.is_cpu() ? Up2::apply(a, height, width) : composed::up2(a, height, width);
}

torch::Tensor offset_layer(const torch::Tensor& first, const torch::Tensor& dt,
                           const torch::Tensor& offsets, const Axis& y, const Axis& x) {
    return first.is_cpu() ? Offset::apply(first, dt, offsets, y, x)
                          : composed::offset_layer(first, dt, offsets, y, x);
}

}  // namespace eventide::fused
