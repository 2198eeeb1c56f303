// A network's shape as the words a model file states it with (docs/model.md, "Model file").
#pragma once

#include "src/model/model_config.h"

#include <map>
#include <string>

namespace eventide {

std::map<std::string, std::string> format_metadata(const ModelConfig& config);

/// The inverse. Throws Error(input) naming `file`, the key, what was expected and what was found,
/// where a key is missing, unknown, or has a value this engine does not have.
ModelConfig parse_metadata(const std::map<std::string, std::string>& metadata,
                           const std::string& file);

/// Refuses a shape no network can have (a width of 0, as many `recurrent` as levels, ...). Throws
/// Error(input) naming `file` and the key.
void check_config(const ModelConfig& config, const std::string& file);

}  // namespace eventide
