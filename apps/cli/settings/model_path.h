// Naming model files.
#pragma once

#include "src/model/model_folders.h"

#include <filesystem>
#include <string>

namespace eventide::app {

/// find_model() for naming files, before anything is opened: empty where there is none, which is
/// said in its turn.
std::filesystem::path found_model(const std::string& name);

}  // namespace eventide::app
