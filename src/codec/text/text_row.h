// One line of a text recording, read with care and without hurry.
#pragma once

#include "src/codec/text/text_layout.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace eventide {

/// The fields of a line: separated by spaces, tabs, a comma or a semicolon, without its end.
std::vector<std::string_view> split_fields(std::string_view line);

/// True for what carries no data and is no damage: blank lines and comments ('#' or '%').
bool is_comment(std::string_view line);

/// "on" and "off", "true" and "false", "t" and "f", in any case; empty for others.
std::optional<bool> polarity_in_words(std::string_view field);

/// "96", also as "9.6e+01"; empty where there are fractions.
std::optional<std::int64_t> whole_number(std::string_view field);

struct TextRow {
    std::int64_t t_us = 0;
    std::int64_t x = 0, y = 0;
    bool on = false;
};

/// Empty where the line is no row of this layout.
std::optional<TextRow> parse_row(std::string_view line, const TextLayout& layout);
std::optional<TextRow> parse_row(std::span<const std::string_view> fields,
                                 const TextLayout& layout);

/// The power of ten between the unit and the microsecond.
int decimal_shift(TextTimeUnit unit);

}  // namespace eventide
