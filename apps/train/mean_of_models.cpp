#include "apps/train/mean_of_models.h"

#include "src/core/error.h"

#include <cmath>
#include <cstddef>
#include <string>

namespace eventide {

namespace {

void check_weights(const std::vector<WeightedModel>& models) {
    double sum = 0;
    for (const WeightedModel& one : models) sum += one.weight;
    if (models.empty() || std::abs(sum - 1) > 1e-6)
        throw Error(ErrorKind::usage,
                    "expected weights that add up to 1, found " + std::to_string(sum));
}

void check_shapes(const std::vector<WeightedModel>& models) {
    const auto shape = expected_tensors(models.front().model.config);
    for (const WeightedModel& one : models)
        if (expected_tensors(one.model.config) != shape)
            throw Error(ErrorKind::input, "expected models of one shape, found another one");
}

}  // namespace

Model mean_of(const std::vector<WeightedModel>& models) {
    check_weights(models);
    check_shapes(models);
    Model mean = models.front().model;
    mean.config.sigma_scale = 0;
    for (auto& [name, tensor] : mean.weights) {
        std::vector<double> sums(tensor.values.size());
        for (const WeightedModel& one : models) {
            const std::vector<float>& values = one.model.weights.at(name).values;
            for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += one.weight * values[i];
        }
        for (std::size_t i = 0; i < sums.size(); ++i) tensor.values[i] = float(sums[i]);
    }
    for (const WeightedModel& one : models)
        mean.config.sigma_scale += float(one.weight) * one.model.config.sigma_scale;
    return mean;
}

}  // namespace eventide
