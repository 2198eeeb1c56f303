#include "apps/train/network/networks.h"

#include "apps/train/fused/fused.h"

namespace eventide {
namespace {

namespace F = torch::nn::functional;

/// Names are looked up below "encoder."; the type of the weights is the type of the arithmetic.
class Layers {
public:
    explicit Layers(const Parameters& parameters)
        : parameters_(parameters), type_(parameters.at("encoder.in.weight").scalar_type()) {}

    const torch::Tensor& at(const std::string& name) const {
        return parameters_.at("encoder." + name);
    }
    torch::Tensor conv(const std::string& name, const torch::Tensor& x, int stride = 1) const {
        return torch::conv2d(x.to(type_), at(name + ".weight"), at(name + ".bias"), stride, 1);
    }
    /// float32 with bfloat16 arithmetic, so that many small steps of a state do not round away.
    torch::Tensor widen(const torch::Tensor& x) const {
        return type_ == torch::kBFloat16 ? x.to(torch::kFloat) : x;
    }
    /// [of a; of b] * x: two layers that read the same.
    torch::Tensor both(const std::string& a, const std::string& b, const torch::Tensor& x) const {
        const auto stacked = [&](const char* part) {
            return torch::cat({at(a + part), at(b + part)});
        };
        return torch::conv2d(x.to(type_), stacked(".weight"), stacked(".bias"), 1, 1);
    }
    /// h + m.u.(c - h), see docs/model.md.
    torch::Tensor gru(const std::string& name, const torch::Tensor& a, const torch::Tensor& h,
                      const torch::Tensor& mask) const {
        if (at(name + ".gates.bias").size(0) == h.size(1)) return light_gru(name, a, h, mask);
        const auto gates = conv(name + ".gates", torch::cat({a, h.to(type_)}, 1)).sigmoid();
        const auto candidate =
            conv(name + ".candidate", torch::cat({a, fused::reset_state(gates, h)}, 1)).tanh();
        return fused::update_state(gates, candidate, h, mask);
    }
    /// The same without a reset gate: what opens the gate and what goes through it read one map.
    torch::Tensor light_gru(const std::string& name, const torch::Tensor& a, const torch::Tensor& h,
                            const torch::Tensor& mask) const {
        const auto halves =
            both(name + ".gates", name + ".candidate", torch::cat({a, h.to(type_)}, 1)).chunk(2, 1);
        return fused::update_state(halves[0].sigmoid(), halves[1].tanh(), h, mask);
    }
    torch::Tensor norm(const std::string& name, const torch::Tensor& x) const;
    torch::ScalarType type() const { return type_; }

private:
    const Parameters& parameters_;
    torch::ScalarType type_;
};

/// InstanceNorm2d+ of docs/model.md; always in float32 or wider.
torch::Tensor Layers::norm(const std::string& name, const torch::Tensor& narrow_x) const {
    const torch::Tensor x = widen(narrow_x);
    const auto mu = x.mean({2, 3}, true);
    const auto var = x.var({2, 3}, false, true);
    const auto M = mu.mean(1, true);
    const auto V = mu.var({1}, true, true);
    const auto shape = [&](const char* part) { return widen(at(name + part)).view({1, -1, 1, 1}); };
    const auto normed =
        (x - mu) / (var + 1e-5).sqrt() + shape(".alpha") * (mu - M) / (V + 1e-5).sqrt();
    return shape(".gamma") * normed + shape(".beta");
}

torch::Tensor up2(const torch::Tensor& a, const torch::Tensor& joined) {
    return fused::up2(a, joined.size(2), joined.size(3));
}

/// m_0 .. m_{L-1} of the gated encoder, float32 0 or 1, [N][1][h][w].
std::vector<torch::Tensor> masks(const ModelConfig& config, const torch::Tensor& grid) {
    const torch::Tensor counts = grid.slice(1, 3, 4 * config.bins, 4).sum(1, /*keepdim=*/true);
    const torch::Tensor mask = (counts > 0).to(grid.scalar_type()).contiguous();
    const auto widen = [](const torch::Tensor& m, int r) {
        return torch::max_pool2d(torch::max_pool2d(m, {1, 2 * r + 1}, {1, 1}, {0, r}),
                                 {2 * r + 1, 1}, {1, 1}, {r, 0});
    };
    std::vector<torch::Tensor> all{widen(mask, config.gate_radius)};
    while (int(all.size()) < config.levels()) all.push_back(torch::max_pool2d(all.back(), 3, 2, 1));
    all.back() = widen(all.back(), config.gate_spread);
    return all;
}

std::string numbered(const char* name, int i) {
    return std::string{name} + "." + std::to_string(i);
}

EncodedGrid encode_gated(const ModelConfig& config, const Layers& layers, const torch::Tensor& grid,
                         const EncoderState& state) {
    const std::vector<torch::Tensor> mask = masks(config, grid);
    const int levels = config.levels();
    EncoderState h;
    for (int l = 0; l < levels; ++l) {
        const auto L = std::size_t(l);
        const auto a = rectify(l == 0 ? layers.conv("in", fused::compressed(grid, layers.type()))
                                      : layers.conv(numbered("down", l), h.back(), 2));
        h.push_back(config.recurrent[L] != 0
                        ? layers.gru(numbered("gru", l), a, state[L], mask[L])
                        : torch::where(mask[L] > 0, layers.widen(a), state[L]));
    }
    torch::Tensor d = h.back().to(layers.type());
    for (int i = 0; i < config.res_blocks; ++i) {
        const std::string name = numbered("res", i);
        d = rectify(d + layers.conv(name + ".1", rectify(layers.conv(name + ".0", d))));
    }
    for (int l = levels - 2; l >= config.latent_stride - 1; --l) {
        const torch::Tensor skip = h[std::size_t(l)].to(layers.type());
        d = rectify(layers.conv(numbered("up", l), torch::cat({up2(d, skip), skip}, 1)));
    }
    return {layers.widen(config.out_layer ? layers.conv("out", d) : d), std::move(h)};
}

EncodedGrid encode_thesis(const Layers& layers, const torch::Tensor& grid,
                          const EncoderState& state) {
    const auto x0 =
        F::elu(layers.norm("norm0", layers.conv("in", fused::compressed(grid, layers.type()))));
    const auto x1 = layers.gru("gru.0", x0.to(layers.type()), state[0], {});
    const auto inner = F::elu(layers.norm("norm1", layers.conv("res.0", x1)));
    const auto x2 = F::elu(x1 + layers.norm("norm2", layers.conv("res.1", inner)));
    const auto h1 = layers.gru("gru.1", F::elu(layers.conv("down", x2, 2)), state[1], {});
    const auto x3 = up2(h1, x0);
    const auto y0 =
        F::elu(layers.norm("norm3", layers.conv("head.0", torch::cat({x3, x2, x0}, 1))));
    const auto y1 = F::elu(y0 + layers.norm("norm4", layers.conv("head.1", y0)));
    return {layers.widen(layers.conv("head.2", y1)), {x1, h1}};
}

}  // namespace

torch::Tensor rectify(const torch::Tensor& x) {
    return x.scalar_type() == torch::kBFloat16 ? torch::leaky_relu(x, 0.0) : torch::relu(x);
}

EncodedGrid encode(const ModelConfig& config, const Parameters& parameters,
                   const torch::Tensor& grid, const EncoderState& state) {
    const Layers layers{parameters};
    const torch::Tensor packed = grid.contiguous(torch::MemoryFormat::ChannelsLast);
    return config.encoder == EncoderKind::gated ? encode_gated(config, layers, packed, state)
                                                : encode_thesis(layers, packed, state);
}

EncoderState empty_state(const ModelConfig& config, std::int64_t streams, std::int64_t height,
                         std::int64_t width, torch::TensorOptions options) {
    const bool gated = config.encoder == EncoderKind::gated;
    EncoderState state;
    for (int l = 0; l < (gated ? config.levels() : 2); ++l) {
        const int channels = config.widths[gated ? std::size_t(l) : 0];
        state.push_back(torch::zeros({streams, channels, height, width}, options)
                            .contiguous(torch::MemoryFormat::ChannelsLast));
        height = (height + 1) / 2;
        width = (width + 1) / 2;
    }
    return state;
}

EncoderState detach(const EncoderState& state) {
    EncoderState cut;
    for (const torch::Tensor& map : state) cut.push_back(map.detach());
    return cut;
}

}  // namespace eventide
