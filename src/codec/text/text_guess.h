// What a text recording's rows say by themselves: the order of the columns, the words for polarity.
#pragma once

#include "src/codec/text/text_layout.h"
#include "src/core/sensor_limits.h"

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace eventide {

using TextFields = std::vector<std::string_view>;  ///< of a row, at least four

/// Pixels, of the sensor; the largest that a recording may have where nothing says it.
struct TextSensor {
    std::int64_t width = kLargestRecordedSide, height = kLargestRecordedSide;
};

/// The order that makes events of most rows, as in TextOptions; "txyp" where others are as good.
/// If a single column has fractions, it has the times; else it is the one that goes on or, where
/// none does, the one that goes furthest.
std::string_view guess_columns(std::span<const TextFields> rows, const TextSensor& sensor);

/// Sets the values that mean off and on where the rows' are 0 and 255, or 1 and 2.
void guess_polarities(std::span<const TextFields> rows, TextLayout& layout);

/// Throws Error (input) where fewer than half of the rows are events in this layout.
void check_rows(std::span<const TextFields> rows, const TextLayout& layout);

/// Throws Error (input) where more than half of many rows are left out because they come more than
/// `reorder` too late; with 0 they are taken as they come.
void check_order(std::span<const TextFields> rows, const TextLayout& layout,
                 SensorDuration reorder);

}  // namespace eventide
