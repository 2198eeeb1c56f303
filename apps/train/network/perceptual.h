// LPIPS-Squeeze (Zhang et al. 2018) with gradients; src/metrics has the one for measuring.
#pragma once

#include "apps/train/torch.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace eventide {

class Perceptual {
public:
    /// The npz file of src/metrics/lpips.h. Throws Error(input). `type` is that of the arithmetic.
    Perceptual(const std::filesystem::path& npz, torch::Device device,
               torch::ScalarType type = torch::kFloat);

    /// Distances [M] of images in [0, 1], at least 17x17: grey [M][h][w], or red, green and blue
    /// [M][3][h][w]. Gradients flow into `image` only.
    torch::Tensor distance(const torch::Tensor& image, const torch::Tensor& truth) const;

private:
    std::vector<torch::Tensor> features(const torch::Tensor& image) const;
    torch::Tensor fire(const std::string& name, const torch::Tensor& x) const;

    std::map<std::string, torch::Tensor> weights_;
    torch::ScalarType type_;
};

}  // namespace eventide
