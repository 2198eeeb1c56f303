// Lines of text -> events, many million a second: a quick way for plain rows, a careful one for
// the rest.
#include "src/codec/text/text.h"

#include "src/codec/text/text_number.h"
#include "src/codec/text/text_row.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>

namespace eventide {

namespace {

constexpr std::size_t kQuickColumns = 8;
// What one field may read behind its beginning: sign, two runs of digits, point, two runs.
constexpr std::ptrdiff_t kFieldReach = 1 + 8 + 8 + 1 + 8 + 8 + 8;

/// A number without exponent: whole + fraction / 10^decimals.
struct QuickNumber {
    std::uint64_t whole = 0, fraction = 0;
    int decimals = 0;
    bool negative = false;
};

/// Up to sixteen digits; a seventeenth is left for the caller to stumble over. Returns their
/// number.
int read_long_digits(const char*& p, std::uint64_t& value) {
    const DigitRun first = read_digits(p);
    p += first.length;
    value = first.value;
    if (first.length < 8) return first.length;
    const DigitRun second = read_digits(p);
    p += second.length;
    value = value * kPowersOfTen[std::size_t(second.length)] + second.value;
    return 8 + second.length;
}

/// False where the field is no plain number.
bool read_number(const char*& p, QuickNumber& number) {
    number.negative = *p == '-';
    p += number.negative;
    if (read_long_digits(p, number.whole) == 0) return false;
    number.decimals = 0;
    number.fraction = 0;
    if (*p == '.') number.decimals = read_long_digits(++p, number.fraction);
    return true;
}

bool is_separator(char c) {
    return c == ' ' || c == ',' || c == '\t' || c == ';';
}

/// Microseconds of a plain number in a unit of 10^shift us; false where it does not fit.
bool to_microseconds(const QuickNumber& number, int shift, std::int64_t& t_us) {
    constexpr std::uint64_t kMaxWhole = 9'000'000'000'000;  // times 10^6 still fits 63 bits
    if (shift < 0 || number.whole > kMaxWhole) return false;
    std::uint64_t us = number.whole * kPowersOfTen[std::size_t(shift)];
    if (number.decimals <= shift) {
        us += number.fraction * kPowersOfTen[std::size_t(shift - number.decimals)];
    } else {
        const std::uint64_t unit = kPowersOfTen[std::size_t(number.decimals - shift)];
        us += (number.fraction + unit / 2) / unit;
    }
    t_us = number.negative ? -std::int64_t(us) : std::int64_t(us);
    return true;
}

}  // namespace

TextParser::TextParser(const TextLayout& layout, int width, int height, SensorDuration reorder)
    : layout_(layout), reorder_(reorder), validator_(std::uint64_t(width), std::uint64_t(height)) {
    assert(layout.unit != TextTimeUnit::automatic && width > 0 && height > 0);
    const auto column = [&](TextField field) {
        return std::size_t(std::find(layout.columns.begin(), layout.columns.end(), field) -
                           layout.columns.begin());
    };
    time_column_ = column(TextField::time);
    x_column_ = column(TextField::x);
    y_column_ = column(TextField::y);
    polarity_column_ = column(TextField::polarity);
    carried_.reserve(kLongestLineBytes);
}

void TextParser::place(std::int64_t t_us, std::uint64_t x, std::uint64_t y, bool on, Batch& into) {
    if (!validator_.is_inside(x, y)) return damage_.count(DamageReason::out_of_range);
    reorder_.push({from_us(t_us), std::uint16_t(x), std::uint16_t(y), Polarity(on)}, taker(into));
}

/// After a jump: what was whole before it comes out, and times begin anew.
void TextParser::take_up(Batch& into) {
    if (!resyncing_) return;
    resyncing_ = false;
    reorder_.flush(taker(into));
    validator_.finish(into, damage_);
    validator_.resync(damage_);
}

/// The line [begin, end), without its newline; false when it is damaged. Nothing is counted then.
bool TextParser::parse_line(const char* begin, const char* end, Batch& into) {
    const std::string_view line(begin, std::size_t(end - begin));
    if (is_comment(line)) return true;
    const auto row = parse_row(line, layout_);
    // A negative coordinate becomes a huge one, outside of every sensor.
    if (row) place(row->t_us, std::uint64_t(row->x), std::uint64_t(row->y), row->on, into);
    return row.has_value();
}

/// Plain rows from p on. Returns where it could not go on: at the beginning of a line that needs
/// the careful way. [p, end) ends with a newline.
const char* TextParser::parse_quickly(const char* p, const char* end, Batch& into) {
    const std::size_t columns = layout_.n_columns;
    if (columns > kQuickColumns) return p;
    const int shift = decimal_shift(layout_.unit);
    const auto off = std::uint64_t(layout_.off), on = std::uint64_t(layout_.on);
    const auto is_polarity = [off, on](const QuickNumber& number) {
        return number.negative ? on == 1 && number.whole <= 1
                               : number.whole == on || number.whole == off;
    };
    const std::ptrdiff_t reach = kFieldReach * std::ptrdiff_t(columns) + 8;
    std::array<QuickNumber, kQuickColumns> numbers;
    while (end - p >= reach) {
        const char* cursor = p;
        for (std::size_t i = 0; i < columns; ++i) {
            if (!read_number(cursor, numbers[i])) return p;
            if (i + 1 == columns) break;
            if (!is_separator(*cursor)) return p;
            ++cursor;
            for (int blanks = 0; *cursor == ' '; ++cursor)
                if (++blanks > 4) return p;
        }
        cursor += *cursor == '\r';
        if (*cursor != '\n') return p;
        const QuickNumber &x = numbers[x_column_], &y = numbers[y_column_],
                          &polarity = numbers[polarity_column_];
        std::int64_t t_us = 0;
        if (!to_microseconds(numbers[time_column_], shift, t_us) || !is_polarity(polarity) ||
            (x.decimals | y.decimals | polarity.decimals) != 0 || x.negative || y.negative)
            return p;
        place(t_us, x.whole, y.whole, polarity.whole == on && !polarity.negative, into);
        p = cursor + 1;
    }
    return p;
}

/// Takes up a line begun in earlier bytes; returns where the next one begins.
const char* TextParser::complete_carried_line(const char* p, const char* end, Batch& into) {
    const auto* newline = static_cast<const char*>(std::memchr(p, '\n', std::size_t(end - p)));
    const char* line_end = newline ? newline : end;
    if (!skipping_to_line_) {
        if (carried_.size() + std::size_t(line_end - p) > kLongestLineBytes) {
            damage_.count(DamageReason::bad_length);
            skipping_to_line_ = true;
            carried_.clear();
        } else {
            carried_.append(p, line_end);
        }
    }
    if (!newline) return end;
    if (!skipping_to_line_ && !parse_line(carried_.data(), carried_.data() + carried_.size(), into))
        damage_.count(DamageReason::bad_record);
    carried_.clear();
    skipping_to_line_ = false;
    return newline + 1;
}

void TextParser::parse(std::span<const std::byte> bytes, Batch& into) {
    take_up(into);
    if (bytes.empty()) return;
    const char* p = reinterpret_cast<const char*>(bytes.data());
    const char* end = p + bytes.size();
    if (!carried_.empty() || skipping_to_line_) p = complete_carried_line(p, end, into);
    while (p < end) {
        p = parse_quickly(p, end, into);
        const auto* newline = static_cast<const char*>(std::memchr(p, '\n', std::size_t(end - p)));
        if (!newline || std::size_t(newline - p) > kLongestLineBytes) {
            p = complete_carried_line(p, end, into);
            continue;
        }
        if (!parse_line(p, newline, into)) damage_.count(DamageReason::bad_record);
        p = newline + 1;
    }
    if (!reorder_.is_empty()) reorder_.drain(taker(into));
}

void TextParser::finish(Batch& into) {
    take_up(into);
    // A last line without a newline is whole when it reads as a row.
    if (!carried_.empty() && !parse_line(carried_.data(), carried_.data() + carried_.size(), into))
        damage_.count(DamageReason::truncated);
    reorder_.flush(taker(into));
    validator_.finish(into, damage_);
    carried_.clear();
    skipping_to_line_ = false;
}

void TextParser::resync() {
    carried_.clear();
    skipping_to_line_ = resyncing_ = true;
}

std::optional<SensorTime> TextParser::clock() const {
    if (resyncing_) return std::nullopt;
    const auto newest =
        std::max(validator_.newest_us(), reorder_.newest_us());  // none is less than any
    return newest ? std::optional(from_us(*newest)) : std::nullopt;
}

}  // namespace eventide
