// A configuration file: keys, and sections of keys.
#include "apps/cli/settings/config.h"
#include "src/core/error.h"

#include <algorithm>

namespace eventide::app {

namespace {

bool is_of_one_value(const SettingValue& value) {
    return value.kind == ValueKind::text || value.kind == ValueKind::number ||
           value.kind == ValueKind::flag;
}

void add(const SettingValue& value, ConfigFile& file) {
    if (!is_of_one_value(value) &&
        (value.kind != ValueKind::list || !std::ranges::all_of(value.items, is_of_one_value)))
        throw Error(ErrorKind::usage, value.place + ": " + value.key +
                                          ": expected text, a number, true, false or a list");
    file.emplace(value.name, value);
}

}  // namespace

ConfigFile read_config_file(const std::string& path) {
    ConfigFile file;
    for (const SettingValue& entry : read_settings_file(path).items) {
        if (entry.kind != ValueKind::table) add(entry, file);
        if (entry.kind == ValueKind::table)
            for (const SettingValue& inner : entry.items) add(inner, file);
    }
    return file;
}

}  // namespace eventide::app
