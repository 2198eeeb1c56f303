#include "apps/train/mean_of_models.h"

#include "src/core/error.h"
#include "src/model/model_metadata.h"

#include <cmath>
#include <cstddef>
#include <string>

namespace eventide {

namespace {

void check_weights(const std::vector<WeightedModel>& models) {
    double sum = 0;
    for (const WeightedModel& one : models) sum += one.weight;
    if (!(std::abs(sum - 1) <= 1e-6))
        throw Error(ErrorKind::usage,
                    "expected weights that add up to 1, found " + std::to_string(sum));
}

/// Weights of one shape mean something else where anything else of the network is not the same.
void check_options(const std::vector<WeightedModel>& models) {
    const auto first = format_metadata(models.front().model.config);
    for (std::size_t i = 1; i < models.size(); ++i)
        for (const auto& [option, found] : format_metadata(models[i].model.config)) {
            const std::string& expected = first.at(option);
            const bool may_differ =
                option == "sigma_scale" || option == "window" || option == "card";
            if (found != expected && !may_differ)
                throw Error(ErrorKind::input, "model " + std::to_string(i + 1) + ": '" + option +
                                                  "': expected " + expected +
                                                  " as of the first, found " + found);
        }
}

}  // namespace

Model mean_of(const std::vector<WeightedModel>& models) {
    check_weights(models);
    check_options(models);
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
