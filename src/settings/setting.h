// One thing that can be set, said once. Flags, environment, configuration files, --print-config,
// config/default.toml, the cameras' files and the options of training all come from tables of
// these.
#pragma once

#include "src/settings/setting_value.h"
#include "src/settings/values.h"
#include "src/settings/words.h"

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace eventide {

struct Setting {
    std::string key;  ///< "sigma_white"; the flag is --sigma-white
    ValueKind kind = ValueKind::text;
    std::string value_name;  ///< "FPS", for help; empty for flags
    std::string help;        ///< one or two sentences, with the values it takes
    std::string short_flag;  ///< "-o", or empty
    std::string group{};     ///< heading in --help; empty: "Options"

    /// Takes the value. Throws Error (usage): "expected ..., found ...".
    std::function<void(const SettingValue&)> set;
    /// The value as words that set() takes.
    std::function<std::vector<std::string>()> show;

    std::string origin = "default";  ///< "default", "file eventide.toml:3", "environment
                                     ///< EVENTIDE_RUN_FPS", "flag --fps"
    bool names_file = false;         ///< or a folder; empty: none, which no flag says
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
/// set(), whose errors then begin with where the value is from: "flag --fps: expected ...".
void set_from(const std::string& origin, const Setting& setting, const SettingValue& value);

Setting text_setting(std::string key, std::string& value, std::string value_name, std::string help);
Setting path_setting(std::string key, std::string& value, std::string value_name, std::string help);
Setting flag_setting(std::string key, bool& value, std::string help = {});
Setting list_setting(std::string key, std::vector<std::string>& value, std::string value_name,
                     std::string help);
/// A whole number from `least` to `most`; without words about it where a file's comments have them.
Setting whole_setting(std::string key, int& value, int least, int most);
Setting whole_setting(std::string key, int& value, std::string value_name, std::string help,
                      int least, int most);
Setting number_setting(std::string key, double& value, std::string value_name, std::string help,
                       double least, double most);

/// A setting of configuration files alone, which takes its value in a way of its own.
Setting file_setting(std::string key, std::function<void(const SettingValue&)> set);

/// A value with its own way of being written. `parse` throws Error (usage).
template <typename T>
Setting parsed_setting(std::string key, T& value, std::string value_name, std::string help,
                       std::function<T(const std::string&)> parse,
                       std::function<std::string(const T&)> show) {
    Setting setting{
        std::move(key), ValueKind::text, std::move(value_name), std::move(help), {}, {}, {}, {}};
    setting.set = [&value, parse = std::move(parse)](const SettingValue& given) {
        value = parse(given.text);
    };
    setting.show = [&value, show = std::move(show)] {
        return std::vector<std::string>{show(value)};
    };
    return setting;
}

/// One of a few words, in quotes where a file has them.
template <typename Enum>
Setting choice_setting(std::string key, Enum& value, std::string help,
                       const std::vector<Word<Enum>>& words) {
    std::string value_name;
    for (const Word<Enum>& word : words)
        value_name += (value_name.empty() ? "" : "|") + std::string{word.text};
    Setting setting = parsed_setting<Enum>(std::move(key), value, value_name, std::move(help), {},
                                           [words](const Enum& v) { return show_word(v, words); });
    setting.set = [words, &value](const SettingValue& given) {
        const auto found = find_word(given.text, words);
        if (!found || !given.may_be(ValueKind::text))
            given.refuse(alternatives(texts_of(words), given.place.empty() ? "" : "\""));
        value = *found;
    };
    return setting;
}

/// A setting that may be left open, written as `word`.
template <typename T>
Setting open_setting(std::string key, std::optional<T>& value, std::string value_name,
                     std::string help, std::string word, T (*parse)(const std::string&),
                     std::string (*show)(const T&)) {
    return parsed_setting<std::optional<T>>(
        std::move(key), value, std::move(value_name), std::move(help),
        [word, parse](const std::string& text) {
            return text == word ? std::nullopt : std::optional<T>{parse(text)};
        },
        [word, show](const std::optional<T>& v) { return v ? show(*v) : word; });
}

/// The same setting, which notes that somebody gave the value.
Setting noted(Setting setting, bool& given);

/// A text as it was given.
std::string same_text(const std::string& text);

}  // namespace eventide
