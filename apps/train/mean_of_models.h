// Several trainings of one network as one: the mean of their weights.
#pragma once

#include "src/model/model_file.h"

#include <vector>

namespace eventide {

struct WeightedModel {
    Model model;
    double weight = 0;
};

/// Networks whose weights lie as near to each other as those of one training and its next turn do
/// about as well as their mean, and usually worse (Wortsman et al. 2022, "Model soups"). Card and
/// window are the first one's; sigma_scale is the mean, too. Throws Error: usage where weights do
/// not add up to 1, input for models that differ in any other option, by its name.
Model mean_of(const std::vector<WeightedModel>& models);

}  // namespace eventide
