// What toml++ has to be spared.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace eventide {

/// toml++ 3 takes for granted that the name of a table begins as a key does and that no '}' stands
/// in place of a list's value, and does not look where assertions are off; and it does not survive
/// some letters in numbers and behind backslashes. Throws Error (usage) naming `path` and the line
/// where a name does not, where such a '}' or such a letter stands, a quote within a word, or a
/// character that is not ASCII outside of strings and comments.
void check_toml(const std::string& path, std::string_view text);

/// A whole file that toml++ may parse. Throws Error: as open_to_read() and check_toml().
std::string read_toml_text(const std::filesystem::path& path);

}  // namespace eventide
