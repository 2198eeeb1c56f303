// Networks that have learned nothing.
#pragma once

#include "src/model/model_file.h"
#include "src/model/model_metadata.h"

#include <cmath>
#include <cstdint>

namespace eventide::test {

/// SplitMix64: small, and the same everywhere, which <random>'s distributions are not.
class WeightSource {
public:
    explicit WeightSource(std::uint64_t seed) : state_(seed) {}
    /// -1 to 1
    float next() {
        std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        // The upper 24 bits as a whole number from -2^23 on: all of them fit a float32.
        return float(std::int64_t(z ^ (z >> 31)) >> 40) * 0x1p-23f;
    }

private:
    std::uint64_t state_;
};

/// A network that has learned nothing but is well scaled (values stay near 1). The same seed gives
/// the same network on every machine.
inline Model random_model(const ModelConfig& config, std::uint64_t seed) {
    Model model{config, {}};
    check_config(config, "random model");
    WeightSource random{seed};
    for (const auto& [name, shape] : expected_tensors(config)) {
        Tensor& tensor = model.weights[name];
        tensor.shape = shape;
        tensor.values.resize(element_count(shape));
        // Uniform of variance 2 / inputs, which keeps the scale through ReLUs (He et al. 2015).
        std::size_t inputs = 1;
        for (std::size_t i = 1; i < shape.size(); ++i) inputs *= std::size_t(shape[i]);
        const bool weight = name.ends_with(".weight"), gamma = name.ends_with(".gamma");
        const float scale = weight ? std::sqrt(6.0F / float(inputs)) : 0.1F;
        for (float& value : tensor.values) value = (gamma ? 1 : 0) + scale * random.next();
    }
    return model;
}

}  // namespace eventide::test
