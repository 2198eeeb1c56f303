// What a text recording's rows say by themselves: the order of the columns, the words for polarity.
#pragma once

#include "src/codec/text/text_layout.h"

#include <span>
#include <string_view>
#include <vector>

namespace eventide {

using TextFields = std::vector<std::string_view>;  ///< of a row, at least four

/// The order that makes events of most rows, as in TextOptions; "txyp" where others are as good.
/// If a single column has fractions, it has the times.
std::string_view guess_columns(std::span<const TextFields> rows);

/// Sets the values that mean off and on where the rows' are 0 and 255, or 1 and 2.
void guess_polarities(std::span<const TextFields> rows, TextLayout& layout);

/// Throws Error (input) where fewer than half of the rows are events in this layout.
void check_rows(std::span<const TextFields> rows, const TextLayout& layout);

}  // namespace eventide
