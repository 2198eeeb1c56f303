// The lines of text at the beginning of AEDAT files.
#include "src/codec/aedat/aedat_header.h"

#include <algorithm>

namespace eventide {

namespace {

std::string_view without_return(std::string_view line) {
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
}

}  // namespace

bool is_aedat_text(char c) {
    return static_cast<unsigned char>(c) >= 0x20 || c == '\t' || c == '\r';
}

bool is_last_aedat_line(std::string_view line) {
    line = without_return(line);
    return line == "#End Of ASCII Header" || line == "#!END-HEADER";
}

AedatHeaderLines read_aedat_lines(std::span<const std::byte> first_bytes) {
    const std::string_view text(reinterpret_cast<const char*>(first_bytes.data()),
                                first_bytes.size());
    AedatHeaderLines header;
    while (header.end < text.size() && text[header.end] == '#') {
        const std::size_t newline = text.find('\n', header.end);
        if (newline == text.npos) break;
        const std::string_view line = text.substr(header.end, newline - header.end);
        if (!std::ranges::all_of(line, is_aedat_text)) break;
        header.end = newline + 1;
        header.lines.push_back(without_return(line.substr(1)));
        if (is_last_aedat_line(line)) break;
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
