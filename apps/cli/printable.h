// Text from files, cameras and command lines, made safe to show on a terminal.
#pragma once

#include "src/io/output_paths.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdio>
#include <string>
#include <string_view>

namespace eventide::app {

enum class Lines { escape, keep };

/// The text with everything a terminal would obey or hide, instead of show, written as \x1b or
/// \u202e: control characters (C0, DEL and C1), marks that change the direction of reading, line
/// and paragraph separators, zero-width characters, bytes that are no UTF-8. Newlines and tabs stay
/// with Lines::keep.
std::string printable(std::string_view text, Lines lines = Lines::escape);

/// JSON in ASCII; bytes that are no UTF-8 become U+FFFD. `indent` as of nlohmann's dump().
std::string json_text(const nlohmann::ordered_json& json, int indent = 2);

/// Where a table for people goes: to standard error where standard output is for the same as data.
inline std::FILE* table_beside(const std::string& data) {
    return is_standard_output(data) ? stderr : stdout;
}

}  // namespace eventide::app
