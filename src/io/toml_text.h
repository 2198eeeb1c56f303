// What toml++ has to be spared.
#pragma once

#include <string>
#include <string_view>

namespace eventide {

/// toml++ 3 takes for granted that the name of a table begins as a key does, and does not look
/// where assertions are off. Throws Error (usage) naming `path` and the line where one does not.
void check_table_names(const std::string& path, std::string_view text);

}  // namespace eventide
