// Both encoders of docs/model.md, line by line, for float and double.
#pragma once

#include "src/model/model_file.h"
#include "src/nn/load_weights.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace eventide::plain {

/// Sizes of the levels: each half of the one before, rounded up.
inline std::vector<std::pair<int, int>> level_sizes(int height, int width, int levels) {
    std::vector<std::pair<int, int>> sizes{{height, width}};
    while (int(sizes.size()) < levels)
        sizes.emplace_back((sizes.back().first + 1) / 2, (sizes.back().second + 1) / 2);
    return sizes;
}

/// m_0 before it is dilated: where a pixel has a count in any bin.
template <typename T>
Mask event_mask(const Array3<T>& grid, int bins) {
    Mask mask{grid.height(), grid.width()};
    for (int y = 0; y < grid.height(); ++y)
        for (int x = 0; x < grid.width(); ++x)
            for (int b = 0; b < bins; ++b)
                if (grid(y, x, 4 * b + 3) != 0) mask(y, x) = 1;
    return mask;
}

template <typename T>
class GatedEncoder {
public:
    GatedEncoder(const Model& model, int height, int width) : config_(model.config) {
        const auto named = [](const char* part, int i) {
            return "encoder." + std::string{part} + "." + std::to_string(i);
        };
        const int levels = config_.levels();
        in_ = conv_weights<T>(model.weights, "encoder.in");
        if (config_.out_layer) out_ = conv_weights<T>(model.weights, "encoder.out");
        for (const auto& [h, w] : level_sizes(height, width, levels))
            states_.emplace_back(h, w, config_.widths[states_.size()]);
        down_.resize(std::size_t(levels));
        gru_.resize(std::size_t(levels));
        up_.resize(std::size_t(levels));
        for (int l = 0; l < levels; ++l) {
            const auto i = std::size_t(l);
            if (l > 0) down_[i] = conv_weights<T>(model.weights, named("down", l));
            if (config_.recurrent[i] != 0) gru_[i] = gru_weights<T>(model.weights, named("gru", l));
            if (l >= config_.latent_stride - 1 && l < levels - 1)
                up_[i] = conv_weights<T>(model.weights, named("up", l));
        }
        for (int i = 0; i < config_.res_blocks; ++i)
            res_.push_back({conv_weights<T>(model.weights, named("res", i) + ".0"),
                            conv_weights<T>(model.weights, named("res", i) + ".1")});
    }

    /// One event window; returns z.
    Array3<T> step(const Array3<T>& grid) {
        advance(grid);
        return read_out();
    }
    std::vector<Array3<T>>& states() { return states_; }
    const std::vector<Array3<T>>& states() const { return states_; }

private:
    /// Down: m_l, a_l and h_l level by level, each from the new h of the level above.
    void advance(const Array3<T>& grid) {
        Mask mask = event_mask(grid, config_.bins);
        Mask scratch = mask;
        dilate(mask, config_.gate_radius, scratch);
        for (std::size_t l = 0; l < states_.size(); ++l) {
            Array3<T>& h = states_[l];
            if (l > 0) {
                Mask half{h.height(), h.width()};
                halve(mask, half);
                mask = half;
            }
            if (l + 1 == states_.size()) {
                scratch = mask;
                dilate(mask, config_.gate_spread, scratch);
            }
            const Array3<T> a = l == 0 ? each(conv(in_, each(grid, compress<T>)), relu<T>)
                                       : each(conv(down_[l], states_[l - 1], 2), relu<T>);
            if (config_.recurrent[l] != 0)
                gru(gru_[l], a, mask, h);
            else
                hold(a, mask, h);
        }
    }
    /// h <- h + m (a - h)
    static void hold(const Array3<T>& a, const Mask& mask, Array3<T>& h) {
        for (int y = 0; y < h.height(); ++y)
            for (int x = 0; x < h.width(); ++x)
                if (mask(y, x) != 0)
                    for (int c = 0; c < h.channels(); ++c) h(y, x, c) = a(y, x, c);
    }
    /// Up: d_{L-1} from h_{L-1} by the residual blocks, d_l = relu(up.l * [up2(d_{l+1}); h_l]), z.
    /// Reads the states only, so that z rests where they rest.
    Array3<T> read_out() const {
        Array3<T> d = states_.back();
        for (const auto& [first, second] : res_)
            d = each(each(d, conv(second, each(conv(first, d), relu<T>)), std::plus<T>{}), relu<T>);
        // To level 0, or 1 where codes have half the resolution.
        for (int l = config_.levels() - 2; l >= config_.latent_stride - 1; --l) {
            const Array3<T>& h = states_[std::size_t(l)];
            const Array3<T> up = up2(d, h.height(), h.width());
            d = each(conv(up_[std::size_t(l)], join<T>({&up, &h})), relu<T>);
        }
        return config_.out_layer ? conv(out_, d) : d;
    }

    ModelConfig config_;
    ConvWeights<T> in_, out_;
    std::vector<ConvWeights<T>> down_, up_;
    std::vector<GruWeights<T>> gru_;
    std::vector<std::pair<ConvWeights<T>, ConvWeights<T>>> res_;
    std::vector<Array3<T>> states_;  // h_l
};

template <typename T>
class ThesisEncoder {
public:
    ThesisEncoder(const Model& model, int height, int width) {
        const Tensors& w = model.weights;
        const int channels = model.config.widths[0];
        for (const char* name : {"in", "res.0", "res.1", "down", "head.0", "head.1", "head.2"})
            conv_[name] = conv_weights<T>(w, "encoder." + std::string{name});
        for (int i = 0; i < 5; ++i)
            norm_.push_back(norm_weights<T>(w, "encoder.norm" + std::to_string(i)));
        for (int i = 0; i < 2; ++i)
            gru_.push_back(gru_weights<T>(w, "encoder.gru." + std::to_string(i)));
        for (const auto& [h, wd] : level_sizes(height, width, 2)) {
            states_.emplace_back(h, wd, channels);
            everywhere_.emplace_back(h, wd);
            std::ranges::fill(everywhere_.back().values(), std::uint8_t{1});
        }
    }

    Array3<T> step(const Array3<T>& grid) {
        const auto plus = std::plus<T>{};
        const Array3<T> x0 =
            each(norm(norm_[0], conv(conv_["in"], each(grid, compress<T>))), elu<T>);
        gru(gru_[0], x0, everywhere_[0], states_[0]);
        const Array3<T>& x1 = states_[0];
        const Array3<T> inner = each(norm(norm_[1], conv(conv_["res.0"], x1)), elu<T>);
        const Array3<T> x2 =
            each(each(x1, norm(norm_[2], conv(conv_["res.1"], inner)), plus), elu<T>);
        gru(gru_[1], each(conv(conv_["down"], x2, 2), elu<T>), everywhere_[1], states_[1]);
        const Array3<T> x3 = up2(states_[1], x2.height(), x2.width());
        const Array3<T> y0 =
            each(norm(norm_[3], conv(conv_["head.0"], join<T>({&x3, &x2, &x0}))), elu<T>);
        const Array3<T> y1 =
            each(each(y0, norm(norm_[4], conv(conv_["head.1"], y0)), plus), elu<T>);
        return conv(conv_["head.2"], y1);
    }
    std::vector<Array3<T>>& states() { return states_; }
    const std::vector<Array3<T>>& states() const { return states_; }

private:
    std::map<std::string, ConvWeights<T>> conv_;
    std::vector<NormWeights<T>> norm_;
    std::vector<GruWeights<T>> gru_;
    std::vector<Array3<T>> states_;  // h0 at full, h1 at half resolution
    std::vector<Mask> everywhere_;
};

}  // namespace eventide::plain
