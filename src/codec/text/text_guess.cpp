// First rows -> their layout, by trial.
#include "src/codec/text/text_guess.h"

#include "src/codec/event_validator.h"
#include "src/codec/reorder.h"
#include "src/codec/text/text_number.h"
#include "src/codec/text/text_row.h"
#include "src/core/duration_text.h"
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
constexpr std::size_t kRowsThatTell = 100;  // whether they come in order of time

bool is_place(std::string_view field, std::int64_t side) {
    const auto place = whole_number(field);
    return place && *place >= 0 && *place < side;
}

bool is_usual_polarity(std::string_view field) {
    const auto p = whole_number(field);
    return p ? *p >= -1 && *p <= 1 : polarity_in_words(field).has_value();
}

/// In any unit, where the row can be an event in this order.
std::optional<std::int64_t> time_of_event(const TextFields& row, std::string_view order,
                                          const TextSensor& sensor) {
    const auto field = [&](char column) { return row[order.find(column)]; };
    if (!is_place(field('x'), sensor.width) || !is_place(field('y'), sensor.height) ||
        !is_usual_polarity(field('p')))
        return {};
    const auto time = parse_decimal(field('t'));
    return time ? scaled_integer(*time, time->fractional ? 6 : 0) : std::nullopt;
}

/// How well the rows can be events in an order.
struct Fit {
    std::size_t rows = 0;
    std::size_t forward = 0;  ///< of them, not before the last: rows may be a little out of order
    double least = std::numeric_limits<double>::infinity(), largest = -least;  ///< times

    bool is_in_order() const { return rows < kRowsThatTell || forward * 10 >= rows * 9; }
    /// Where no order has the times ascend, one of four columns of random numbers seems to most.
    bool is_better_than(const Fit& other) const {
        if (rows != other.rows) return rows > other.rows;
        if (is_in_order() || other.is_in_order()) return forward > other.forward;
        return largest - least > other.largest - other.least;
    }
};

Fit fit_of(std::span<const TextFields> rows, std::string_view order, const TextSensor& sensor) {
    Fit fit;
    std::int64_t last = std::numeric_limits<std::int64_t>::min();
    for (const TextFields& row : rows) {
        const auto t = time_of_event(row, order, sensor);
        if (!t) continue;
        ++fit.rows;
        fit.forward += *t >= last;
        last = *t;
        fit.least = std::min(fit.least, double(*t));
        fit.largest = std::max(fit.largest, double(*t));
    }
    return fit;
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

std::string_view guess_columns(std::span<const TextFields> rows, const TextSensor& sensor) {
    const std::size_t times = fractional_column(rows);
    std::string_view best = kOrders.front();
    Fit most;
    for (const std::string_view order : kOrders) {
        if (times < 4 && order[times] != 't') continue;
        const Fit fit = fit_of(rows, order, sensor);
        if (!fit.is_better_than(most)) continue;
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

void check_order(std::span<const TextFields> rows, const TextLayout& layout,
                 SensorDuration reorder) {
    if (rows.size() < kRowsThatTell || reorder == SensorDuration{0}) return;
    Reorder in_order{reorder};
    EventValidator validator{1, 1};
    Batch taken;
    Damage damage;
    const auto take = [&](const Event& event) {
        validator.add(to_us(event.t), 0, 0, true, taken, damage);
    };
    for (const TextFields& row : rows)
        if (const auto event = parse_row(row, layout)) in_order.push({from_us(event->t_us)}, take);
    in_order.flush(take);
    const std::uint64_t late = damage[DamageReason::time_backwards];
    if (2 * late <= rows.size()) return;
    throw Error(ErrorKind::input,
                "text recording: expected rows \"" + order_text(layout) +
                    "\" in order of time, at most " + duration_text(reorder) + " late; found " +
                    std::to_string(late) + " of " + std::to_string(rows.size()) +
                    " later than that; sort the rows by time, or state a larger --reorder or "
                    "another order of columns (--input-columns)");
}

}  // namespace eventide
