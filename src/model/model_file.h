// A trained network as a file: its shape, its weights, and the checks that the two belong together.
#pragma once

#include "src/model/model_config.h"
#include "src/nn/safetensors.h"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace eventide {

struct Model {
    ModelConfig config;
    Tensors weights;  ///< names as in docs/model.md, with "encoder." or "renderer." before them
};

/// Every tensor a network of this shape has, by name and shape.
std::vector<std::pair<std::string, std::vector<std::int64_t>>> expected_tensors(
    const ModelConfig& config);

/// Throws Error(input) naming `file` and the tensor, with what was expected and what was found,
/// where one is missing, surplus, of another shape, or not finite.
void check_model(const Model& model, const std::string& file);

/// Reads and checks. Throws Error(input).
Model load_model(const std::filesystem::path& path);

/// Checks, then writes whole or not at all. Throws Error.
void save_model(const std::filesystem::path& path, const Model& model, bool overwrite = true);

/// A number that tells models apart: of the encoder's shape and weights, which a hidden state
/// belongs to. 16 hexadecimal digits.
std::string encoder_identity(const Model& model);

/// The same for the whole network: of all that says how it computes, and of its weights. What was
/// measured of a model holds for every one of this identity. 16 hexadecimal digits.
std::string model_identity(const Model& model);

}  // namespace eventide
