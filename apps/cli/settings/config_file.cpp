// TOML through toml++; our own walk, because unknown keys are errors with a line number here.
#include "apps/cli/settings/config.h"
#include "src/core/error.h"
#include "src/io/toml_text.h"

#include <toml++/toml.h>

namespace eventide::app {

namespace {

std::string place_of(const std::string& path, const toml::source_region& region) {
    return path + ":" + std::to_string(region.begin.line);
}

/// One value as text; false for what no setting is (dates, tables in lists).
bool append(const toml::node& node, ConfigValue& value) {
    if (const auto* text = node.as_string()) {
        value.texts.push_back(text->get());
        value.kind = ValueKind::text;
    } else if (const auto* whole = node.as_integer()) {
        value.texts.push_back(std::to_string(whole->get()));
        value.kind = ValueKind::number;
    } else if (const auto* number = node.as_floating_point()) {
        value.texts.push_back(show_number(number->get()));
        value.kind = ValueKind::number;
    } else if (const auto* flag = node.as_boolean()) {
        value.texts.push_back(flag->get() ? "true" : "false");
        value.kind = ValueKind::flag;
    } else {
        return false;
    }
    return true;
}

ConfigValue value_of(const std::string& path, const toml::key& key, const toml::node& node) {
    ConfigValue value{{}, ValueKind::list, place_of(path, key.source())};
    bool readable = true;
    if (const auto* list = node.as_array()) {
        for (const toml::node& item : *list) readable = append(item, value) && readable;
        value.kind = ValueKind::list;
    } else {
        readable = append(node, value);
    }
    if (!readable)
        throw Error(ErrorKind::usage, value.place + ": " + std::string{key.str()} +
                                          ": expected text, a number, true, false or a list");
    return value;
}

}  // namespace

ConfigFile read_config_file(const std::string& path) {
    const std::string text = read_toml_text(path);
    ConfigFile file;
    try {
        const toml::table root = toml::parse(text, path);
        for (const auto& [key, node] : root) {
            const auto* section = node.as_table();
            if (section == nullptr) {
                file.emplace(std::string{key.str()}, value_of(path, key, node));
                continue;
            }
            for (const auto& [inner_key, inner] : *section)
                file.emplace(std::string{key.str()} + "." + std::string{inner_key.str()},
                             value_of(path, inner_key, inner));
        }
    } catch (const toml::parse_error& error) {
        throw Error(ErrorKind::usage, place_of(path, error.source()) +
                                          ": not TOML: " + std::string{error.description()});
    }
    return file;
}

}  // namespace eventide::app
