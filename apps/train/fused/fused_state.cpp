// The recurrent unit's two steps as functions of autograd's around their loops.
#include "apps/train/fused/fused.h"
#include "apps/train/fused/fused_loops.h"
#include "apps/train/fused/fused_types.h"

namespace eventide::fused {
namespace {

using torch::autograd::AutogradContext;
using torch::autograd::variable_list;

torch::Tensor map_like(const torch::Tensor& x, std::int64_t channels, torch::ScalarType type) {
    return torch::empty({x.size(0), channels, x.size(2), x.size(3)}, x.options().dtype(type),
                        torch::MemoryFormat::ChannelsLast);
}

MapSize size_of(const torch::Tensor& h, const torch::Tensor& gates) {
    return {h.size(0) * h.size(2) * h.size(3), h.size(1), gates.size(1)};
}

struct Reset : torch::autograd::Function<Reset> {
    static torch::Tensor forward(AutogradContext* ctx, const torch::Tensor& gates_in,
                                 const torch::Tensor& h_in) {
        const torch::Tensor gates = packed(gates_in), h = packed(h_in);
        ctx->save_for_backward({gates, h});
        const torch::Tensor out = map_like(h, h.size(1), gates.scalar_type());
        for_type(gates.scalar_type(), [&]<typename T, typename W>(T, W) {
            reset_forward<T, W>(size_of(h, gates), gates.data_ptr<T>(), h.data_ptr<W>(),
                                out.data_ptr<T>());
        });
        return out;
    }
    static variable_list backward(AutogradContext* ctx, const variable_list& grads) {
        const auto saved = ctx->get_saved_variables();
        const torch::Tensor &gates = saved[0], &h = saved[1], g = packed(grads[0]);
        torch::Tensor g_gates = torch::empty_like(gates), g_h = torch::empty_like(h);
        for_type(gates.scalar_type(), [&]<typename T, typename W>(T, W) {
            reset_backward<T, W>(size_of(h, gates), gates.data_ptr<T>(), h.data_ptr<W>(),
                                 g.data_ptr<T>(), g_gates.data_ptr<T>(), g_h.data_ptr<W>());
        });
        return {g_gates, g_h};
    }
};

struct Update : torch::autograd::Function<Update> {
    static torch::Tensor forward(AutogradContext* ctx, const torch::Tensor& gates_in,
                                 const torch::Tensor& candidate_in, const torch::Tensor& h_in,
                                 const torch::Tensor& mask_in) {
        const torch::Tensor gates = packed(gates_in), candidate = packed(candidate_in),
                            h = packed(h_in), mask = mask_in.contiguous();
        ctx->save_for_backward({gates, candidate, h, mask});
        torch::Tensor out = torch::empty_like(h);
        for_type(gates.scalar_type(), [&]<typename T, typename W>(T, W) {
            update_forward<T, W>(size_of(h, gates), gates.data_ptr<T>(), candidate.data_ptr<T>(),
                                 h.data_ptr<W>(), mask_of<W>(mask), out.data_ptr<W>());
        });
        return out;
    }
    static variable_list backward(AutogradContext* ctx, const variable_list& grads) {
        const auto saved = ctx->get_saved_variables();
        const torch::Tensor &gates = saved[0], &candidate = saved[1], &h = saved[2],
                            &mask = saved[3], g = packed(grads[0]);
        torch::Tensor g_gates = torch::empty_like(gates), g_h = torch::empty_like(h),
                      g_candidate = torch::empty_like(candidate);
        for_type(gates.scalar_type(), [&]<typename T, typename W>(T, W) {
            update_backward<T, W>(size_of(h, gates), gates.data_ptr<T>(), candidate.data_ptr<T>(),
                                  h.data_ptr<W>(), mask_of<W>(mask), g.data_ptr<W>(),
                                  g_gates.data_ptr<T>(), g_candidate.data_ptr<T>(),
                                  g_h.data_ptr<W>());
        });
        return {g_gates, g_candidate, g_h, torch::Tensor{}};
    }
    /// Autograd takes no undefined inputs: an empty mask stands for 1 everywhere.
    template <typename W>
    static const W* mask_of(const torch::Tensor& mask) {
        return mask.numel() > 0 ? mask.data_ptr<W>() : nullptr;
    }
};

}  // namespace

torch::Tensor reset_state(const torch::Tensor& gates, const torch::Tensor& h) {
    return h.is_cpu() ? Reset::apply(gates, h) : composed::reset_state(gates, h);
}

torch::Tensor update_state(const torch::Tensor& gates, const torch::Tensor& candidate,
                           const torch::Tensor& h, const torch::Tensor& mask) {
    if (!h.is_cpu()) return composed::update_state(gates, candidate, h, mask);
    return Update::apply(gates, candidate, h,
                         mask.defined() ? mask : torch::empty({0}, h.options()));
}

}  // namespace eventide::fused
