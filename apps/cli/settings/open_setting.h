// Settings that may be left open, and those that note that somebody gave them.
#pragma once

#include "apps/cli/settings/setting.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace eventide::app {

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
inline Setting noted(Setting setting, bool& given) {
    setting.set = [set = std::move(setting.set), &given](const std::vector<std::string>& texts) {
        set(texts);
        given = true;
    };
    return setting;
}

/// As it was given.
inline std::string same_text(const std::string& text) {
    return text;
}

}  // namespace eventide::app
