// Where models are found.
#pragma once

#include <filesystem>
#include <string>

namespace eventide::app {

/// A file that exists stands for itself. Else NAME.safetensors is looked for in $EVENTIDE_MODELS,
/// beside the installed program (../share/eventide/models) and in the source tree the program was
/// built from (config/models). Throws Error (input) naming the places and the models there.
std::filesystem::path find_model(const std::string& name);

}  // namespace eventide::app
