#include "apps/train/network/parameters.h"

#include "src/core/error.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace eventide {
namespace {

torch::Tensor initial(const std::string& name, const std::vector<std::int64_t>& shape) {
    if (name.ends_with(".gamma")) return torch::ones(shape);
    if (!name.ends_with(".weight")) return torch::zeros(shape);
    std::int64_t inputs = 1;
    for (std::size_t i = 1; i < shape.size(); ++i) inputs *= shape[i];
    // He et al. 2015 before a ReLU; half the variance where a sigmoid, a tanh or nothing follows.
    const bool linear = name.find(".gru.") != name.npos || name.find(".out.") != name.npos;
    const double bound = std::sqrt((linear ? 3.0 : 6.0) / double(inputs));
    return torch::empty(shape).uniform_(-bound, bound);
}

}  // namespace

Parameters initial_parameters(const ModelConfig& config, std::uint64_t seed, torch::Device device) {
    torch::manual_seed(seed);
    Parameters parameters;
    for (const auto& [name, shape] : expected_tensors(config))
        parameters[name] = initial(name, shape);
    // The second half of a residual block starts small, so that the block starts as the identity.
    for (auto& [name, values] : parameters)
        if (name.find(".res.") != name.npos && name.ends_with(".1.weight")) values *= 0.1;
    // An update gate near .27 at first: states remember some frames before they learn to.
    for (auto& [name, values] : parameters)
        if (name.ends_with(".gates.bias"))
            values.narrow(0, 0, config.reset_gate ? values.size(0) / 2 : values.size(0)).fill_(-1);
    const std::string last = "renderer.mlp." + std::to_string(config.mlp.size());
    parameters.at(last + ".weight") *= 0.1;
    parameters.at(last + ".bias")[0] = 0.45;  // mean grey of auto-exposed images
    parameters.at(last + ".bias")[1] = -1.5;  // sigma .22: about the spread of grey levels
    for (auto& [name, values] : parameters) values = values.to(device).set_requires_grad(true);
    return parameters;
}

torch::Tensor input_mask(const ModelConfig& config, const std::vector<std::string>& inputs) {
    torch::Tensor mask = torch::zeros({1, config.input_channels(), 1, 1});
    for (const std::string& name : inputs) {
        const auto at = std::ranges::find(kGridInputs, name) - kGridInputs.begin();
        if (at == std::ssize(kGridInputs))
            throw Error(
                ErrorKind::usage,
                "--inputs: expected polarity, mean, std, count or since, found '" + name + "'");
        if (name == "since")
            mask[0][4 * config.bins] = 1;
        else
            for (int b = 0; b < config.bins; ++b) mask[0][4 * b + at] = 1;
    }
    return mask;
}

Tensor to_tensor(const torch::Tensor& values) {
    const torch::Tensor flat = values.detach().to(torch::kCPU, torch::kFloat).contiguous();
    Tensor tensor{flat.sizes().vec(), std::vector<float>(std::size_t(flat.numel()))};
    std::memcpy(tensor.values.data(), flat.data_ptr<float>(), tensor.values.size() * sizeof(float));
    return tensor;
}

Tensors to_tensors(const Parameters& parameters) {
    Tensors tensors;
    for (const auto& [name, values] : parameters) tensors[name] = to_tensor(values);
    return tensors;
}

torch::Tensor to_torch(const Tensor& tensor, torch::Device device) {
    torch::Tensor values = torch::empty(tensor.shape);
    std::memcpy(values.data_ptr<float>(), tensor.values.data(),
                tensor.values.size() * sizeof(float));
    return values.to(device);
}

Parameters to_parameters(const Tensors& tensors, torch::Device device) {
    Parameters parameters;
    for (const auto& [name, tensor] : tensors)
        parameters[name] = to_torch(tensor, device).set_requires_grad(true);
    return parameters;
}

Parameters cast(const Parameters& parameters, torch::ScalarType type) {
    Parameters result;
    for (const auto& [name, values] : parameters) result[name] = values.to(type);
    return result;
}

}  // namespace eventide
