// One line of a text recording.
#include "src/codec/text/text_row.h"

#include "src/codec/text/text_number.h"
#include "src/core/lower_case.h"

#include <algorithm>
#include <cstdlib>
#include <string>

namespace eventide {

namespace {

constexpr std::string_view kBlank = " \t\r\n";

std::optional<bool> parse_polarity(std::string_view field, const TextLayout& layout) {
    if (const auto word = polarity_in_words(field)) return word;
    const auto value = whole_number(field);
    if (value == layout.on) return true;
    if (value == layout.off || (value == -1 && layout.on == 1)) return false;
    return {};
}

}  // namespace

std::optional<std::int64_t> whole_number(std::string_view field) {
    const auto value = parse_decimal(field);
    if (!value) return {};
    const auto whole = scaled_integer(*value, 0);
    // "9.6e+01" is a whole number, "9.5" is not: a tenth must not change it.
    if (!whole) return {};
    if (value->fractional &&
        scaled_integer(*value, 1) !=
            scaled_integer({std::uint64_t(std::abs(*whole)), 0, *whole < 0, false}, 1))
        return {};
    return whole;
}

std::optional<bool> polarity_in_words(std::string_view field) {
    constexpr std::size_t kLongest = 5;
    if (field.empty() || field.size() > kLongest) return {};
    const std::string word = lower_case(field);
    if (word == "on" || word == "true" || word == "t") return true;
    if (word == "off" || word == "false" || word == "f") return false;
    return {};
}

std::vector<std::string_view> split_fields(std::string_view line) {
    std::vector<std::string_view> fields;
    std::size_t i = line.find_first_not_of(kBlank);
    while (i < line.size()) {
        const std::size_t end = std::min(line.find_first_of(" \t\r\n,;", i), line.size());
        fields.push_back(line.substr(i, end - i));
        i = std::min(line.find_first_not_of(kBlank, end), line.size());
        if (i < line.size() && (line[i] == ',' || line[i] == ';'))
            i = std::min(line.find_first_not_of(kBlank, i + 1), line.size());
    }
    return fields;
}

bool is_comment(std::string_view line) {
    const std::size_t first = line.find_first_not_of(kBlank);
    return first == line.npos || line[first] == '#' || line[first] == '%';
}

int decimal_shift(TextTimeUnit unit) {
    switch (unit) {
        case TextTimeUnit::automatic:
        case TextTimeUnit::seconds:
            return 6;
        case TextTimeUnit::milliseconds:
            return 3;
        case TextTimeUnit::microseconds:
            return 0;
        case TextTimeUnit::nanoseconds:
            return -3;
    }
    return 0;
}

std::optional<TextRow> parse_row(std::string_view line, const TextLayout& layout) {
    return parse_row(split_fields(line), layout);
}

std::optional<TextRow> parse_row(std::span<const std::string_view> fields,
                                 const TextLayout& layout) {
    if (fields.size() < layout.n_columns) return {};
    TextRow row;
    for (std::size_t i = 0; i < layout.n_columns; ++i) {
        std::optional<std::int64_t> value = 0;
        switch (layout.columns[i]) {
            case TextField::time:
                if (const auto time = parse_decimal(fields[i]))
                    value = scaled_integer(*time, decimal_shift(layout.unit));
                else
                    value = {};
                row.t_us = value.value_or(0);
                break;
            case TextField::x:
                value = whole_number(fields[i]), row.x = value.value_or(0);
                break;
            case TextField::y:
                value = whole_number(fields[i]), row.y = value.value_or(0);
                break;
            case TextField::polarity:
                if (const auto on = parse_polarity(fields[i], layout))
                    row.on = *on;
                else
                    value = {};
                break;
            case TextField::ignored:
                break;
        }
        if (!value) return {};
    }
    return row;
}

}  // namespace eventide
