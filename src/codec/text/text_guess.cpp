// First rows -> their layout, by trial.
#include "src/codec/text/text_guess.h"

#include "src/codec/text/text_number.h"
#include "src/codec/text/text_row.h"
#include "src/core/error.h"
#include "src/core/sensor_limits.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <utility>

namespace eventide {
namespace {

// The first of those that are as good is meant.
constexpr std::array<std::string_view, 5> kOrders{"txyp", "xytp", "xypt", "tpxy", "pxyt"};
constexpr std::array<std::pair<int, int>, 2> kOtherPolarities{{{0, 255}, {1, 2}}};
constexpr std::size_t kDamageIsOneIn = 10;  // rows; what is more frequent is meant

bool is_place(std::string_view field) {
    const auto place = whole_number(field);
    return place && *place >= 0 && *place < kLargestRecordedSide;
}

bool is_usual_polarity(std::string_view field) {
    const auto p = whole_number(field);
    return p ? *p >= -1 && *p <= 1 : polarity_in_words(field).has_value();
}

/// In any unit, where the row can be an event in this order.
std::optional<std::int64_t> time_of_event(const TextFields& row, std::string_view order) {
    const auto field = [&](char column) { return row[order.find(column)]; };
    if (!is_place(field('x')) || !is_place(field('y')) || !is_usual_polarity(field('p'))) return {};
    const auto time = parse_decimal(field('t'));
    return time ? scaled_integer(*time, time->fractional ? 6 : 0) : std::nullopt;
}

/// How many of the rows can be events in this order, and of these, how many are not before the
/// last: rows may be a little out of order.
std::pair<std::size_t, std::size_t> rows_that_fit(std::span<const TextFields> rows,
                                                  std::string_view order) {
    std::size_t fit = 0, forward = 0;
    std::int64_t last = std::numeric_limits<std::int64_t>::min();
    for (const TextFields& row : rows) {
        const auto t = time_of_event(row, order);
        if (!t) continue;
        ++fit;
        forward += *t >= last;
        last = *t;
    }
    return {fit, forward};
}

/// A polarity as floating point: "1.0", "-1.00"; not the fraction of a second that begins alike.
bool is_polarity_with_point(std::string_view field) {
    const std::size_t point = field.find('.');
    return point != field.npos && is_usual_polarity(field.substr(0, point)) &&
           field.find_first_not_of('0', point + 1) == field.npos;
}

/// The one column that has fractions, 0 to 3; 4 where none or several have. Polarities as floating
/// point are none.
std::size_t fractional_column(std::span<const TextFields> rows) {
    std::array<bool, 4> fractions{};
    for (const TextFields& row : rows)
        for (std::size_t i = 0; i < 4; ++i) {
            const auto value = parse_decimal(row[i]);
            fractions[i] |= value && value->fractional && !is_polarity_with_point(row[i]);
        }
    if (std::count(fractions.begin(), fractions.end(), true) != 1) return 4;
    return std::size_t(std::find(fractions.begin(), fractions.end(), true) - fractions.begin());
}

std::string order_text(const TextLayout& layout) {
    std::string text;
    for (std::size_t i = 0; i < layout.n_columns; ++i)
        text += (i > 0 ? " " : "") + std::string(1, "txyp-"[std::size_t(layout.columns[i])]);
    return text;
}

}  // namespace

std::string_view guess_columns(std::span<const TextFields> rows) {
    const std::size_t times = fractional_column(rows);
    std::string_view best = kOrders.front();
    std::pair<std::size_t, std::size_t> most{0, 0};
    for (const std::string_view order : kOrders) {
        if (times < 4 && order[times] != 't') continue;
        const auto fit = rows_that_fit(rows, order);
        if (fit <= most) continue;
        most = fit;
        best = order;
    }
    return best;
}

void guess_polarities(std::span<const TextFields> rows, TextLayout& layout) {
    const auto column =
        std::size_t(std::find(layout.columns.begin(), layout.columns.end(), TextField::polarity) -
                    layout.columns.begin());
    for (const auto& [off, on] : kOtherPolarities) {
        std::size_t n_off = 0, n_on = 0;
        for (const TextFields& row : rows) {
            const auto value = column < row.size() ? whole_number(row[column]) : std::nullopt;
            n_off += value == off;
            n_on += value == on;
        }
        const std::size_t n_other = rows.size() - n_off - n_on;
        if (n_on == 0 || n_on * kDamageIsOneIn < rows.size() ||
            n_other * kDamageIsOneIn > rows.size())
            continue;
        layout.off = off;
        layout.on = on;
    }
}

void check_rows(std::span<const TextFields> rows, const TextLayout& layout) {
    const auto is_event = [&](const TextFields& row) { return parse_row(row, layout).has_value(); };
    const auto fit = std::size_t(std::ranges::count_if(rows, is_event));
    if (2 * fit >= rows.size()) return;
    const auto other = std::ranges::find_if_not(rows, is_event);
    std::string text;
    for (const std::string_view field : *other)
        text += (text.empty() ? "" : " ") + std::string(field);
    throw Error(
        ErrorKind::input,
        "text recording: expected rows \"" + order_text(layout) +
            "\" with polarities 0 and 1, -1 and 1, 1 and 2, 0 and 255, or in words; found \"" +
            text.substr(0, 60) + "\", and " + std::to_string(rows.size() - fit) +
            " rows like it of " + std::to_string(rows.size()) +
            "; --input-columns states another order");
}

}  // namespace eventide
