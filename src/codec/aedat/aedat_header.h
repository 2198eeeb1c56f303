// The lines of text at the beginning of AEDAT 1, 2 and 3 files.
#pragma once

#include "src/codec/stream.h"

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace eventide {

struct AedatHeaderLines {
    std::vector<std::string_view> lines;  ///< without the '#' and the line's end
    std::size_t end = 0;                  ///< bytes up to the first record
};

/// Whether a header line may contain this character.
bool is_aedat_text(char c);
/// Whether `line`, without its '\n', ends the header: records follow it, even where they look like
/// another line.
bool is_last_aedat_line(std::string_view line);

/// Lines that begin with '#' and are text; "#End Of ASCII Header" and "#!END-HEADER" are the last
/// where they are. Binary data that happen to begin with '#' are not taken for a line.
AedatHeaderLines read_aedat_lines(std::span<const std::byte> first_bytes);

/// What follows "key" and any ':' or spaces on the first line that begins with it; empty without.
std::string_view find_value(const AedatHeaderLines& header, std::string_view key);

}  // namespace eventide
