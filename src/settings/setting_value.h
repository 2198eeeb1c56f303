// What somebody wrote for a setting: words of a command line, or a value of a file with its place.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace eventide {

enum class ValueKind {
    text,    ///< one value
    number,  ///< one value, written without quotes in TOML
    flag,    ///< true or false; on the command line --x or --no-x
    list,    ///< any number of values
    table,   ///< values by name; of files alone, as is
    date     ///< a date or time of day, which is no setting's value
};

/// "a number", for errors.
std::string name_of(ValueKind kind);

struct SettingValue {
    ValueKind kind = ValueKind::text;
    std::string text;                 ///< as it is written; of several words the last
    std::vector<SettingValue> items;  ///< of a list or table
    std::string key;                  ///< in the table it stands in: "PrBp"
    std::string name;                 ///< from the top: "biases.PrBp"; of a list's items the list's
    std::string place;                ///< "camera.toml:3"; empty: no file's

    SettingValue() = default;
    SettingValue(std::string word) : text{std::move(word)} {}
    SettingValue(const std::vector<std::string>& words);

    /// All texts of a list; else the one text.
    std::vector<std::string> texts() const;
    /// Words may be of any kind; what a file holds is of the kind that is written there.
    bool may_be(ValueKind wanted) const { return place.empty() || kind == wanted; }
    /// Throws Error (usage): "expected ..., found ...", of a file's value with place and name.
    [[noreturn]] void refuse(const std::string& expected) const;
};

/// A whole number from `least` to `most`; anything else is refused.
std::int64_t whole_of(const SettingValue& value, std::int64_t least, std::int64_t most);

/// A TOML file, as a table. Throws Error (usage): with file and line for what is not TOML, and when
/// the file cannot be read.
SettingValue read_settings_file(const std::filesystem::path& path);

}  // namespace eventide
