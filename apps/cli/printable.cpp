// UTF-8 taken apart, and put together again without what is not for people.
#include "apps/cli/printable.h"

#include "src/core/utf8.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdio>

namespace eventide::app {

namespace {

bool is_obeyed_or_hidden(char32_t code) {
    const auto between = [code](char32_t first, char32_t last) {
        return code >= first && code <= last;
    };
    return code < 0x20 || between(0x7F, 0x9F) || code == 0x00AD || code == 0x061C ||
           between(0x200B, 0x200F) || between(0x2028, 0x202E) || between(0x2060, 0x206F) ||
           code == 0xFEFF || between(0xFFF9, 0xFFFB) || between(0xE0000, 0xE007F);
}

std::string escaped(const char* format, char32_t code) {
    char text[16];
    std::snprintf(text, sizeof text, format, unsigned(code));
    return text;
}

}  // namespace

std::string printable(std::string_view text, Lines lines) {
    std::string shown;
    shown.reserve(text.size());
    while (!text.empty()) {
        const Character c = first_character(text);
        const std::size_t n = std::max<std::size_t>(c.bytes, 1);
        const bool kept = lines == Lines::keep && (c.code == '\n' || c.code == '\t');
        if (c.bytes == 0)
            shown += escaped("\\x%02x", static_cast<unsigned char>(text[0]));
        else if (kept || !is_obeyed_or_hidden(c.code))
            shown += text.substr(0, n);
        else
            shown += escaped(c.code < 0x80 ? "\\x%02x" : "\\u%04x", c.code);
        text.remove_prefix(n);
    }
    return shown;
}

std::string json_text(const nlohmann::ordered_json& json, int indent) {
    return json.dump(indent, ' ', true, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace eventide::app
