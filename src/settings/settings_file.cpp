// TOML through toml++, into values that know where they stand.
#include "src/core/error.h"
#include "src/settings/setting_value.h"
#include "src/settings/toml_text.h"
#include "src/settings/values.h"

#include <toml++/toml.h>

namespace eventide {

namespace {

std::string place_of(const std::string& path, const toml::source_region& region) {
    return path + ":" + std::to_string(region.begin.line);
}

SettingValue value_of(const std::string& path, const std::string& name, const toml::node& node) {
    SettingValue value;
    value.name = name;
    value.place = place_of(path, node.source());
    if (const auto* text = node.as_string()) {
        value.text = text->get();
    } else if (const auto* whole = node.as_integer()) {
        value.kind = ValueKind::number;
        value.text = std::to_string(whole->get());
    } else if (const auto* number = node.as_floating_point()) {
        value.kind = ValueKind::number;
        value.text = show_number(number->get());
    } else if (const auto* flag = node.as_boolean()) {
        value.kind = ValueKind::flag;
        value.text = flag->get() ? "true" : "false";
    } else if (const auto* list = node.as_array()) {
        value.kind = ValueKind::list;
        for (const toml::node& item : *list) value.items.push_back(value_of(path, name, item));
    } else if (const auto* table = node.as_table()) {
        value.kind = ValueKind::table;
        for (const auto& [key, item] : *table) {
            const std::string own{key.str()};
            std::string full = name;
            if (!full.empty()) full += '.';
            value.items.push_back(value_of(path, full += own, item));
            value.items.back().key = own;
        }
    } else {
        value.kind = ValueKind::date;
    }
    return value;
}

}  // namespace

SettingValue read_settings_file(const std::filesystem::path& path) {
    const std::string text = read_toml_text(path);
    try {
        return value_of(path.string(), {}, toml::parse(text, path.string()));
    } catch (const toml::parse_error& error) {
        throw Error(ErrorKind::usage, place_of(path.string(), error.source()) +
                                          ": not TOML: " + std::string{error.description()});
    }
}

}  // namespace eventide
