// Where models are found.
#pragma once

#include <filesystem>
#include <string>

namespace eventide {

/// A file that exists stands for itself. Else NAME.safetensors is looked for in $EVENTIDE_MODELS,
/// then from the folder of the library or program with this code, and of the process' program,
/// upwards: in share/eventide/models (installed) and in a source tree's config/models. Throws Error
/// (input) naming the places and the models there.
std::filesystem::path find_model(const std::string& name);

}  // namespace eventide
