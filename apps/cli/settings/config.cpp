// The layers of the configuration, and how it is printed.
#include "apps/cli/settings/config.h"

#include "apps/cli/printable.h"
#include "src/core/environment.h"
#include "src/core/error.h"
#include "src/core/list_text.h"
#include "src/core/text_piece.h"
#include "src/settings/suggestion.h"

#include <algorithm>
#include <cstdio>
#include <ostream>
#include <sstream>
#include <string_view>
#include <utility>

namespace eventide::app {

namespace {

/// Variables that mean something but are no settings.
constexpr std::string_view kOtherVariables[]{"EVENTIDE_CONFIG", "EVENTIDE_MODELS"};

std::string path_of(const SettingTable& table, const Setting& setting) {
    return table.section.empty() ? setting.key : table.section + "." + setting.key;
}

std::vector<std::string> split(const std::string& text, char separator) {
    std::vector<std::string> parts;
    std::istringstream stream{text};
    for (std::string part; std::getline(stream, part, separator);)
        if (!part.empty()) parts.push_back(part);
    return parts;
}

std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        const auto code = static_cast<unsigned char>(c);
        if (code < 0x20 || code == 0x7F) {  // TOML has these escaped
            char escaped[8];
            std::snprintf(escaped, sizeof escaped, "\\u%04X", unsigned(code));
            out += escaped;
            continue;
        }
        if (c == '"' || c == '\\') out += '\\';
        out += c;
    }
    return printable(out) + "\"";
}

std::string toml_value(const Setting& setting) {
    const std::vector<std::string> texts = setting.show();
    if (setting.kind == ValueKind::number || setting.kind == ValueKind::flag) return texts.back();
    if (setting.kind == ValueKind::text) return quoted(texts.back());
    return "[" + list_of(texts, quoted) + "]";
}

/// At most 96 characters a line, each after "# ".
void print_comment(std::ostream& out, const std::string& text) {
    std::istringstream words{text};
    std::string line = "#";
    for (std::string word; words >> word;) {
        if (line.size() + 1 + word.size() > 98) {
            out << line << '\n';
            line = "#";
        }
        line += " " + word;
    }
    out << line << '\n';
}

void set(Setting& setting, const SettingValue& value, const std::string& origin) {
    set_from(origin, setting, value);
    setting.origin = origin;
}

/// A file says true or "text" or 3 or a list; a flag wants true, a list takes one text too.
bool fits(ValueKind wanted, ValueKind found) {
    if (wanted == ValueKind::list) return found == ValueKind::list || found == ValueKind::text;
    if (wanted == ValueKind::flag) return found == ValueKind::flag;
    return found == ValueKind::text || found == ValueKind::number;
}

/// A variable of a script that is not set, where a file was meant, is no wish for none.
void set_from_flag(Setting& setting, const std::vector<std::string>& words) {
    const std::string origin = "flag " + flag_of(setting);
    if (setting.names_file && words.back().empty())
        throw Error(ErrorKind::usage, origin + ": expected " + setting.value_name + ", found ''");
    set(setting, words, origin);
}

void set_from_file(Setting& setting, SettingValue value) {
    if (!fits(setting.kind, value.kind))
        throw Error(ErrorKind::usage, value.place + ": " + value.name + ": expected " +
                                          name_of(setting.kind) + ", found " + name_of(value.kind));
    // What it says is taken as words are, which other places give.
    const std::string origin = "file " + std::exchange(value.place, {});
    try {
        set(setting, value, origin);
    } catch (const Error& error) {
        throw Error(error.kind(), value.name + ": " + error.what());
    }
}

}  // namespace

void refuse_unknown_keys(const ConfigFile& file, const std::vector<const SettingTable*>& tables) {
    std::vector<std::string> known;
    for (const SettingTable* table : tables)
        for (const Setting& setting : table->settings) known.push_back(path_of(*table, setting));
    for (const auto& [path, value] : file)
        if (std::ranges::find(known, path) == known.end())
            throw Error(ErrorKind::usage, value.place + ": unknown key '" + piece_of(path) + "'" +
                                              suggestion(path, known) +
                                              "; `eventide --default-config` shows all keys");
}

std::vector<std::string> unknown_variables(const char* const* environment,
                                           const std::vector<const SettingTable*>& tables) {
    std::vector<std::string> known{std::begin(kOtherVariables), std::end(kOtherVariables)};
    for (const SettingTable* table : tables)
        for (const Setting& setting : table->settings)
            known.push_back(environment_of(*table, setting));
    std::vector<std::string> unknown;
    for (; *environment != nullptr; ++environment) {
        const std::string_view entry{*environment};
        const std::string name{entry.substr(0, entry.find('='))};
        if (name.starts_with("EVENTIDE_") && std::ranges::find(known, name) == known.end())
            unknown.push_back(name);
    }
    return unknown;
}

void resolve_settings(SettingTable& table, const ConfigFile& file,
                      const std::map<std::string, std::vector<std::string>>& flags) {
    for (Setting& setting : table.settings) {
        const std::string variable = environment_of(table, setting);
        const char* const from_environment = environment_value(variable.c_str());
        const std::string path = path_of(table, setting);
        if (const auto flag = flags.find(setting.key); flag != flags.end()) {
            set_from_flag(setting, flag->second);
        } else if (from_environment != nullptr && *from_environment != '\0') {
            set(setting,
                setting.kind == ValueKind::list ? SettingValue{split(from_environment, ';')}
                                                : SettingValue{from_environment},
                "environment " + variable);
        } else if (const auto entry = file.find(path); entry != file.end()) {
            set_from_file(setting, entry->second);
        }
    }
}

void print_config(std::ostream& out, const std::vector<const SettingTable*>& tables, bool explain) {
    bool first = true;
    for (const SettingTable* table : tables) {
        if (table->settings.empty()) continue;
        if (!first) out << '\n';
        first = false;
        if (explain) print_comment(out, table->title);
        if (!table->section.empty()) out << '[' << table->section << "]\n";
        for (const Setting& setting : table->settings) {
            const std::string line = setting.key + " = " + toml_value(setting);
            if (explain) {
                out << '\n';
                print_comment(out, setting.help);
                out << line << '\n';
            } else {
                out << line << std::string(line.size() < 40 ? 40 - line.size() : 1, ' ') << "# "
                    << printable(setting.origin) << '\n';
            }
        }
    }
}

}  // namespace eventide::app
