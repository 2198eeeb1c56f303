// One thing a user can set, said once: flags, environment, configuration file, --print-config and
// config/default.toml all come from tables of these.
#pragma once

#include "apps/cli/settings/values.h"
#include "apps/cli/settings/words.h"
#include "src/core/error.h"

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace eventide::app {

enum class ValueKind {
    text,    ///< one value
    number,  ///< one value, written without quotes in TOML
    flag,    ///< true or false; on the command line --x or --no-x
    list     ///< any number of values
};

struct Setting {
    std::string key;  ///< "sigma_white"; the flag is --sigma-white
    ValueKind kind = ValueKind::text;
    std::string value_name;  ///< "FPS", for help; empty for flags
    std::string help;        ///< one or two sentences, with the values it takes
    std::string short_flag;  ///< "-o", or empty
    std::string group{};     ///< heading in --help; empty: "Options"

    /// Reads the value from text. Throws Error (usage): "expected ..., found ...".
    std::function<void(const std::vector<std::string>&)> set;
    /// The value as text that set() reads back.
    std::function<std::vector<std::string>()> show;

    // Filled by resolve_settings().
    std::string origin = "default";  ///< "default", "file eventide.toml:3", "environment
                                     ///< EVENTIDE_RUN_FPS", "flag --fps"
};

/// The settings of one command, or those all commands share (section empty).
struct SettingTable {
    std::string section;  ///< TOML table: "run"
    std::string title;    ///< a comment over it
    std::vector<Setting> settings;

    /// Puts those that are in no group yet under this heading.
    void group_rest(const std::string& heading);
};

std::string flag_of(const Setting& setting);
/// What it does, and behind it in brackets its value, of lists all: for help before anything is
/// set.
std::string help_with_default(const Setting& setting);
/// "EVENTIDE_RUN_FPS"; without a section "EVENTIDE_QUIET".
std::string environment_of(const SettingTable& table, const Setting& setting);

Setting text_setting(std::string key, std::string& value, std::string value_name, std::string help);
Setting flag_setting(std::string key, bool& value, std::string help);
Setting list_setting(std::string key, std::vector<std::string>& value, std::string value_name,
                     std::string help);
/// A whole number from `least` to `most`.
Setting whole_setting(std::string key, int& value, std::string value_name, std::string help,
                      int least, int most);
Setting number_setting(std::string key, double& value, std::string value_name, std::string help,
                       double least, double most);

/// A value with its own way of being written. `parse` throws Error (usage).
template <typename T>
Setting parsed_setting(std::string key, T& value, std::string value_name, std::string help,
                       std::function<T(const std::string&)> parse,
                       std::function<std::string(const T&)> show) {
    Setting setting{
        std::move(key), ValueKind::text, std::move(value_name), std::move(help), {}, {}, {}, {}};
    setting.set = [&value, parse = std::move(parse)](const std::vector<std::string>& texts) {
        value = parse(texts.back());
    };
    setting.show = [&value, show = std::move(show)] {
        return std::vector<std::string>{show(value)};
    };
    return setting;
}

/// One of a few words.
template <typename Enum>
Setting choice_setting(std::string key, Enum& value, std::string help,
                       const std::vector<Word<Enum>>& words) {
    std::string value_name;
    for (const Word<Enum>& word : words)
        value_name += (value_name.empty() ? "" : "|") + std::string{word.text};
    return parsed_setting<Enum>(
        std::move(key), value, value_name, std::move(help),
        [words](const std::string& text) { return parse_word(text, words); },
        [words](const Enum& v) { return show_word(v, words); });
}

}  // namespace eventide::app
