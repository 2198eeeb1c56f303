// The lines of text at the beginning of AEDAT files.
#include "src/codec/aedat/aedat_header.h"

#include <algorithm>

namespace eventide {

namespace {

bool is_text_line(std::string_view line) {
    return std::all_of(line.begin(), line.end(), [](char c) {
        return static_cast<unsigned char>(c) >= 0x20 || c == '\t' || c == '\r';
    });
}

}  // namespace

AedatHeaderLines read_aedat_lines(std::span<const std::byte> first_bytes) {
    const std::string_view text(reinterpret_cast<const char*>(first_bytes.data()),
                                first_bytes.size());
    AedatHeaderLines header;
    while (header.end < text.size() && text[header.end] == '#') {
        const std::size_t newline = text.find('\n', header.end);
        if (newline == text.npos) break;
        std::string_view line = text.substr(header.end, newline - header.end);
        if (!is_text_line(line)) break;
        header.end = newline + 1;
        line.remove_prefix(1);
        if (line.ends_with('\r')) line.remove_suffix(1);
        header.lines.push_back(line);
        if (line == "End Of ASCII Header" || line == "!END-HEADER") break;
    }
    return header;
}

std::string_view find_value(const AedatHeaderLines& header, std::string_view key) {
    for (std::string_view line : header.lines) {
        line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
        if (!line.starts_with(key)) continue;
        line.remove_prefix(key.size());
        line.remove_prefix(std::min(line.find_first_not_of(" \t:"), line.size()));
        return line.substr(0, line.find_last_not_of(" \t\r") + 1);
    }
    return {};
}

}  // namespace eventide
