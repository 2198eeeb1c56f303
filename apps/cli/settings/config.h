// Where values come from: flags over environment over configuration file over defaults.
#pragma once

#include "src/settings/setting.h"

#include <iosfwd>
#include <map>
#include <string>
#include <vector>

namespace eventide::app {

/// What a TOML file says, by "section.key" or "key".
using ConfigFile = std::map<std::string, SettingValue>;

/// Throws Error (usage): as read_settings_file(), and with file and line for what nests too deep or
/// is something else than text, numbers, true, false and lists of them.
ConfigFile read_config_file(const std::string& path);

/// Throws Error (usage) naming file and line of the first key that no table has.
void refuse_unknown_keys(const ConfigFile& file, const std::vector<const SettingTable*>& tables);

/// Names of EVENTIDE_... variables that no table has and that mean nothing else: a typing error
/// most likely. `environment` is "NAME=value" strings as in environ.
std::vector<std::string> unknown_variables(const char* const* environment,
                                           const std::vector<const SettingTable*>& tables);

/// Sets every setting of the table from the highest layer that has it, and notes the origin.
/// `flags` are the values given on the command line, by key. A list in the environment is separated
/// by ';'. Throws Error (usage) naming the origin of a value that cannot be read.
void resolve_settings(SettingTable& table, const ConfigFile& file,
                      const std::map<std::string, std::vector<std::string>>& flags);

/// As TOML that read_config_file() takes: each value with its origin, or, with `explain`, with its
/// help over it.
void print_config(std::ostream& out, const std::vector<const SettingTable*>& tables, bool explain);

}  // namespace eventide::app
