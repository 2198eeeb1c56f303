// Naming model files.
#pragma once

#include "src/model/model_folders.h"

#include <filesystem>
#include <string>

namespace eventide::app {

/// The file that a model's name stands for, to compare it with other files before anything is
/// opened. Empty where find_model() finds none: opening the model says so later.
std::filesystem::path found_model(const std::string& name);

}  // namespace eventide::app
