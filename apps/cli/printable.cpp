// UTF-8 taken apart, and put together again without what is not for people.
#include "apps/cli/printable.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>

namespace eventide::app {

namespace {

struct Character {
    std::uint32_t code = 0;
    std::size_t bytes = 0;  ///< 0: not UTF-8
};

/// The first character of a text that is not empty; no overlong forms, no surrogates.
Character first_of(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned lead = byte(0);
    if (lead < 0x80) return {lead, 1};
    const std::size_t n = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
    if (lead < 0xC2 || lead > 0xF4 || text.size() < n) return {};
    std::uint32_t code = lead & (0x7FU >> n);
    for (std::size_t i = 1; i < n; ++i) {
        if ((byte(i) & 0xC0) != 0x80) return {};
        code = code << 6 | (byte(i) & 0x3F);
    }
    constexpr std::uint32_t kLeast[]{0, 0, 0x80, 0x800, 0x10000};
    const bool surrogate = code >= 0xD800 && code <= 0xDFFF;
    if (code < kLeast[n] || code > 0x10FFFF || surrogate) return {};
    return {code, n};
}

bool is_obeyed_or_hidden(std::uint32_t code) {
    const auto between = [code](std::uint32_t first, std::uint32_t last) {
        return code >= first && code <= last;
    };
    return code < 0x20 || between(0x7F, 0x9F) || code == 0x00AD || code == 0x061C ||
           between(0x200B, 0x200F) || between(0x2028, 0x202E) || between(0x2060, 0x206F) ||
           code == 0xFEFF || between(0xFFF9, 0xFFFB) || between(0xE0000, 0xE007F);
}

std::string escaped(const char* format, std::uint32_t code) {
    char text[16];
    std::snprintf(text, sizeof text, format, unsigned(code));
    return text;
}

}  // namespace

std::string printable(std::string_view text, Lines lines) {
    std::string shown;
    shown.reserve(text.size());
    while (!text.empty()) {
        const Character c = first_of(text);
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
