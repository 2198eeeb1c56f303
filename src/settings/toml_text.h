// What toml++ has to be spared.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace eventide {

/// `text` as toml++ 3 may read it, with the same lines, names and values. toml++ takes for granted
/// that the name of a table begins as a key does and that no '}' stands in place of a list's value,
/// and it does not survive some characters that are not ASCII in or behind numbers and backslashes:
/// here these are escape sequences of strings. Throws Error (usage) naming `path` and the line
/// where a name does not, where such a '}' stands, a character that is not ASCII outside of strings
/// and comments, or what is not UTF-8 inside.
std::string plain_toml(const std::string& path, std::string_view text);

/// A whole file so. Throws Error: as open_to_read() and plain_toml().
std::string read_toml_text(const std::filesystem::path& path);

}  // namespace eventide
