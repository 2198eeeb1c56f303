// Text in tables of comma separated values.
#pragma once

#include <string>

namespace eventide {

/// As RFC 4180 has it: in quotes where a comma, a quote or the end of a line would end it.
inline std::string csv_field(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
    return quoted + "\"";
}

}  // namespace eventide
