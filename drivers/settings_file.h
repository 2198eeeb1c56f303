// A camera's TOML settings: every key known, every value in range, refused with file and line.
#pragma once

#include "src/settings/setting.h"

#include <filesystem>
#include <string>
#include <vector>

namespace eventide {

/// Gives every value of the file to its setting. All refusals are Error (usage).
void read_camera_settings(const std::filesystem::path& file, const std::vector<Setting>& settings);

/// One of a few numbers.
Setting one_of_setting(std::string key, int& into, std::vector<int> allowed);

}  // namespace eventide
