// The learned numbers of a network as torch tensors, under the names and shapes of the model file.
#pragma once

#include "apps/train/torch.h"
#include "src/model/model_file.h"

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace eventide {

using Parameters = std::map<std::string, torch::Tensor>;

/// A network that can start to learn: He's uniform for weights, gates that keep, and a renderer
/// that begins at mid grey with a wide sigma. The same seed gives the same numbers.
Parameters initial_parameters(const ModelConfig& config, std::uint64_t seed, torch::Device device);

/// The channels of the voxel grid by name, in the order of the binner; the last is there once.
inline constexpr std::array<const char*, 5> kGridInputs{"polarity", "mean", "std", "count",
                                                        "since"};

/// 1 for the channels named, else 0: [1][4B+1][1][1]. The first layer's weights times it use no
/// other. The activity gate still sees every event. Throws Error(usage) for another name.
torch::Tensor input_mask(const ModelConfig& config, const std::vector<std::string>& inputs);

/// Copies of the numbers, float32 on the host.
Tensors to_tensors(const Parameters& parameters);
Tensor to_tensor(const torch::Tensor& values);

/// Leaves that want gradients.
Parameters to_parameters(const Tensors& tensors, torch::Device device);
torch::Tensor to_torch(const Tensor& tensor, torch::Device device);

/// The same numbers in another type; gradients flow through to the float32 masters.
Parameters cast(const Parameters& parameters, torch::ScalarType type);

}  // namespace eventide
