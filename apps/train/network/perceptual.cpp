#include "apps/train/network/perceptual.h"

#include "apps/train/network/networks.h"
#include "apps/train/network/parameters.h"
#include "src/io/npz.h"

namespace eventide {
namespace {

constexpr int kLayers = 7;

/// 2 x - 1, shift and scale are folded into the first layer. Grey enters as three equal channels,
/// so for it the three input planes are added up once and images stay one channel wide.
void fold_input(std::map<std::string, torch::Tensor>& weights) {
    const torch::Tensor weight = weights.at("core.net.slice1.0.weight");  // [64][3][3][3]
    const torch::Tensor scale = weights.at("core.scaling_layer.scale").view({1, 3, 1, 1});
    const torch::Tensor shift = weights.at("core.scaling_layer.shift").view({1, 3, 1, 1});
    const torch::Tensor constant = (-1 - shift) / scale * weight;
    weights["bias"] = weights.at("core.net.slice1.0.bias") + constant.sum({1, 2, 3});
    weights["colour"] = 2 / scale * weight;
    weights["grey"] = weights.at("colour").sum(1, true);
}

}  // namespace

Perceptual::Perceptual(const std::filesystem::path& npz, torch::Device device,
                       torch::ScalarType type)
    : type_(type) {
    const NpzFile file{npz};
    const auto take = [&](const std::string& name) {
        NpzArray array = file.array(name);
        weights_[name] = to_torch({array.shape, std::move(array.values)}, device);
    };
    for (const char* part : {"core.net.slice1.0.weight", "core.net.slice1.0.bias",
                             "core.scaling_layer.shift", "core.scaling_layer.scale"})
        take(part);
    for (const char* name : {"slice2.3", "slice2.4", "slice3.6", "slice3.7", "slice4.9",
                             "slice5.10", "slice6.11", "slice7.12"})
        for (const char* part : {".squeeze", ".expand1x1", ".expand3x3"})
            for (const char* kind : {".weight", ".bias"})
                take("core.net." + std::string{name} + part + kind);
    for (int i = 0; i < kLayers; ++i) take("core.lins." + std::to_string(i) + ".model.1.weight");
    fold_input(weights_);
    for (auto& [name, values] : weights_)
        if (!name.starts_with("core.lins")) values = values.to(type);
}

torch::Tensor Perceptual::fire(const std::string& name, const torch::Tensor& x) const {
    const auto layer = [&](const char* part, const torch::Tensor& in, int padding) {
        const std::string full = "core.net." + name + part;
        return rectify(torch::conv2d(in, weights_.at(full + ".weight"), weights_.at(full + ".bias"),
                                     1, padding));
    };
    const torch::Tensor squeezed = layer(".squeeze", x, 0);
    return torch::cat({layer(".expand1x1", squeezed, 0), layer(".expand3x3", squeezed, 1)}, 1);
}

std::vector<torch::Tensor> Perceptual::features(const torch::Tensor& image) const {
    const auto pooled = [](const torch::Tensor& x) {
        return torch::max_pool2d(x, 3, 2, 0, 1, /*ceil_mode=*/true);
    };
    std::vector<torch::Tensor> f;
    const bool grey = image.dim() == 3;
    const torch::Tensor planes = (grey ? image.unsqueeze(1) : image).to(type_);
    f.push_back(rectify(
        torch::conv2d(planes, weights_.at(grey ? "grey" : "colour"), weights_.at("bias"), 2)));
    f.push_back(fire("slice2.4", fire("slice2.3", pooled(f.back()))));
    f.push_back(fire("slice3.7", fire("slice3.6", pooled(f.back()))));
    f.push_back(fire("slice4.9", pooled(f.back())));
    f.push_back(fire("slice5.10", f.back()));
    f.push_back(fire("slice6.11", f.back()));
    f.push_back(fire("slice7.12", f.back()));
    for (torch::Tensor& x : f) {
        x = x.to(torch::kFloat);
        // The root's slope is infinite at 0, where a pixel's features all vanish.
        x = x / (x.square().sum(1, true) + 1e-10).sqrt();
    }
    return f;
}

torch::Tensor Perceptual::distance(const torch::Tensor& image, const torch::Tensor& truth) const {
    std::vector<torch::Tensor> wanted;
    {
        const torch::NoGradGuard none;
        wanted = features(truth);
    }
    const std::vector<torch::Tensor> found = features(image);
    torch::Tensor sum;
    for (int i = 0; i < kLayers; ++i) {
        const auto& head = weights_.at("core.lins." + std::to_string(i) + ".model.1.weight");
        const auto I = std::size_t(i);
        const auto part = ((found[I] - wanted[I]).square() * head).sum(1).mean({1, 2});
        sum = sum.defined() ? sum + part : part;
    }
    return sum;
}

}  // namespace eventide
