// FireNet and E2VID as their papers lay them out, with random weights: for their time, not their
// images. libtorch.
#pragma once

#include <torch/torch.h>

#include <vector>

namespace eventide::bench {

/// A convolution that keeps the size (stride 1) or halves it.
struct PeerConv {
    PeerConv(int in, int out, int side, int stride = 1)
        : weight(torch::randn({out, in, side, side}) * .05),
          bias(torch::zeros({out})),
          step(stride),
          pad(side / 2) {}
    torch::Tensor operator()(const torch::Tensor& x) const {
        return torch::conv2d(x, weight, bias, step, pad);
    }
    void to(torch::ScalarType type, torch::MemoryFormat format) {
        weight = weight.to(type).contiguous(format);
        bias = bias.to(type);
    }
    torch::Tensor weight, bias;
    int step, pad;
};

/// A recurrent network: a voxel grid in, an image out.
class PeerNetwork {
public:
    virtual ~PeerNetwork() = default;
    virtual torch::Tensor step(const torch::Tensor& grid) = 0;
    void to(torch::ScalarType type, torch::MemoryFormat format) {
        for (PeerConv& conv : convs_) conv.to(type, format);
        states_.clear();
    }

protected:
    /// relu(x + second(relu(first(x))))
    torch::Tensor block(const torch::Tensor& x, std::size_t first) const {
        return torch::relu(x + convs_[first + 1](torch::relu(convs_[first](x))));
    }
    std::vector<PeerConv> convs_;
    std::vector<torch::Tensor> states_;  // empty: the first step
};

/// Scheerlinck et al. 2020: 16 channels at full resolution, head, twice ConvGRU and block, 1x1.
class FireNet final : public PeerNetwork {
public:
    FireNet() {
        constexpr int kWidth = 16, kBins = 5;
        convs_.emplace_back(kBins, kWidth, 3);
        for (int part = 0; part < 2; ++part) {
            for (int gate = 0; gate < 3; ++gate) convs_.emplace_back(2 * kWidth, kWidth, 3);
            for (int i = 0; i < 2; ++i) convs_.emplace_back(kWidth, kWidth, 3);
        }
        convs_.emplace_back(kWidth, 1, 1);
    }
    torch::Tensor step(const torch::Tensor& grid) override {
        torch::Tensor x = torch::relu(convs_[0](grid));
        if (states_.empty()) states_ = {torch::zeros_like(x), torch::zeros_like(x)};
        for (std::size_t part = 0; part < 2; ++part) {
            const std::size_t first = 1 + 5 * part;
            torch::Tensor& h = states_[part];
            const torch::Tensor joined = torch::cat({x, h}, 1);
            const torch::Tensor update = torch::sigmoid(convs_[first](joined));
            const torch::Tensor reset = torch::sigmoid(convs_[first + 1](joined));
            const torch::Tensor fresh =
                torch::tanh(convs_[first + 2](torch::cat({x, h * reset}, 1)));
            h = h * (1 - update) + fresh * update;
            x = block(h, first + 3);
        }
        return convs_.back()(x);
    }
};

/// Rebecq et al. 2019: head of 32, three levels of 5x5 at stride 2 with a ConvLSTM each, two
/// blocks, three levels up by bilinear doubling and 5x5, skips added.
class E2Vid final : public PeerNetwork {
public:
    E2Vid() {
        constexpr int kBins = 5, kBase = 32;
        convs_.emplace_back(kBins, kBase, 5);
        for (int c = kBase; c < 8 * kBase; c *= 2) {
            convs_.emplace_back(c, 2 * c, 5, 2);
            convs_.emplace_back(4 * c, 8 * c, 3);  // the four gates over [x; h]
        }
        for (int i = 0; i < 4; ++i) convs_.emplace_back(8 * kBase, 8 * kBase, 3);
        for (int c = 8 * kBase; c > kBase; c /= 2) convs_.emplace_back(c, c / 2, 5);
        convs_.emplace_back(kBase, 1, 1);
    }
    torch::Tensor step(const torch::Tensor& grid) override {
        const torch::Tensor head = torch::relu(convs_[0](grid));
        torch::Tensor x = head;
        std::vector<torch::Tensor> skips;
        const bool is_first = states_.empty();
        if (is_first) states_.resize(6);
        for (std::size_t level = 0; level < 3; ++level) {
            x = torch::relu(convs_[1 + 2 * level](x));
            torch::Tensor &h = states_[2 * level], &cell = states_[2 * level + 1];
            if (is_first) h = torch::zeros_like(x), cell = torch::zeros_like(x);
            const auto gates = convs_[2 + 2 * level](torch::cat({x, h}, 1)).chunk(4, 1);
            cell =
                torch::sigmoid(gates[1]) * cell + torch::sigmoid(gates[0]) * torch::tanh(gates[3]);
            h = torch::sigmoid(gates[2]) * torch::tanh(cell);
            x = h;
            skips.push_back(x);
        }
        x = block(block(x, 7), 9);
        for (std::size_t level = 0; level < 3; ++level) {
            x = torch::upsample_bilinear2d(x + skips[2 - level], {2 * x.size(2), 2 * x.size(3)},
                                           false);
            x = torch::relu(convs_[11 + level](x));
        }
        return torch::sigmoid(convs_[14](x + head));
    }
};

}  // namespace eventide::bench
