// The manual page and the shells' completion, out of the tables that the flags come from.
#pragma once

#include "apps/cli/command.h"

#include <memory>
#include <string>
#include <vector>

namespace eventide::app {

using Commands = std::vector<std::unique_ptr<Command>>;

/// eventide(1), for man.
std::string manual_page(const SettingTable& common, const Commands& commands);

/// Commands, their flags, and the words a flag takes; else files.
std::string bash_completion(const SettingTable& common, const Commands& commands);
std::string zsh_completion(const SettingTable& common, const Commands& commands);
std::string fish_completion(const SettingTable& common, const Commands& commands);

}  // namespace eventide::app
