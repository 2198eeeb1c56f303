// The text before Prophesee's RAW and DAT records: lines of "% key value".
#pragma once

#include "src/codec/stream.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace eventide {

/// The lines, as far as they are such lines; old files have no "% end".
struct PercentLines {
    std::vector<std::pair<std::string, std::string>> values;
    std::size_t bytes = 0;  ///< of all lines

    std::string_view value(std::string_view key) const;  ///< empty when there is none
};
PercentLines read_percent_lines(std::span<const std::byte> first_bytes);

/// Whether `line`, which is not empty, can be the beginning of such a line, or is all of one with
/// its newline. Only its last character is looked at: the same was asked for what comes before.
bool is_percent_line_so_far(std::string_view line);
/// "% end"; with its newline.
bool is_last_percent_line(std::string_view line);

struct EvtHeader {
    StreamHeader stream;          ///< format "evt2", "evt21" or "evt3"
    bool halves_swapped = false;  ///< EVT2.1 with the upper half of each word first
    /// us to add to all times; our own writer's, for times the 24 bits of EVT3 do not reach.
    std::int64_t time_base_us = 0;
};

/// Empty when it is no RAW file of a format read here.
std::optional<EvtHeader> find_evt_header(std::span<const std::byte> first_bytes);

/// What a RAW file's lines call its format, also one that is not read: "EVT3", "2.0", "HISTO3D".
/// Empty where they do not say it.
std::string evt_format_said(std::span<const std::byte> first_bytes);

/// Whether the header of a RAW or DAT file says that words of another format than this one of RAW
/// ("evt3") follow it. Old ones say nothing.
bool is_of_other_format(std::span<const std::byte> header, std::string_view format);

/// `format` and where the data begin, for a RAW file whose lines, if any, do not say the format.
EvtHeader stated_evt_header(std::span<const std::byte> first_bytes, std::string_view format);

/// Throws Error (input) naming what was found.
EvtHeader read_evt_header(std::span<const std::byte> first_bytes);

}  // namespace eventide
