// Finds out how a text recording is written from its first lines.
#include "src/codec/text/text_layout.h"

#include "src/codec/text/text_guess.h"
#include "src/codec/text/text_number.h"
#include "src/codec/text/text_row.h"
#include "src/codec/text/text_time_unit.h"
#include "src/core/error.h"
#include "src/core/lower_case.h"
#include "src/core/sensor_limits.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace eventide {

namespace {

constexpr std::size_t kRowsToLookAt = 1000;
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

using Fields = TextFields;

using Sides = std::array<std::int64_t, 2>;  // width and height, px

/// The "width height" of a first line of two whole numbers.
std::optional<Sides> geometry_of(const Fields& fields) {
    if (fields.size() != 2) return {};
    Sides sides{};
    for (std::size_t i = 0; i < 2; ++i) {
        const auto value = parse_decimal(fields[i]);
        if (!value || value->fractional || value->negative) return {};
        const auto side = scaled_integer(*value, 0);
        if (!side) return {};
        sides[i] = *side;
    }
    return sides;
}

/// "%geometry:1280,720", as Metavision writes it.
std::optional<Sides> size_in_comment(std::string_view line) {
    constexpr std::string_view kTitle = "geometry:";
    const std::size_t begin = std::min(line.find_first_not_of(" \t#%"), line.size());
    if (!line.substr(begin).starts_with(kTitle)) return {};
    return geometry_of(split_fields(line.substr(begin + kTitle.size())));
}

/// The lines that carry something, one after the other, with their place.
class Lines {
public:
    explicit Lines(std::string_view text) : text_(text) {
        if (text_.starts_with(kByteOrderMark)) position_ = kByteOrderMark.size();
    }

    std::optional<std::string_view> next() {
        while (position_ < text_.size()) {
            const std::size_t end = std::min(text_.find('\n', position_), text_.size());
            const auto line = text_.substr(position_, end - position_);
            line_begin_ = position_;
            position_ = std::min(end + 1, text_.size());
            if (!is_comment(line)) return line;
            if (!size_) size_ = size_in_comment(line);
        }
        return {};
    }
    /// The sensor's, from a comment so far.
    std::optional<Sides> size() const { return size_; }
    std::size_t line_begin() const { return line_begin_; }  ///< of the line next() gave

private:
    std::string_view text_;
    std::size_t position_ = 0, line_begin_ = 0;
    std::optional<Sides> size_;
};

std::string_view as_text(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

bool is_number(std::string_view field) {
    return parse_decimal(field).has_value();
}

bool is_row(const Fields& fields) {
    if (fields.size() < 4) return false;
    const auto numbers = std::count_if(fields.begin(), fields.begin() + 4, is_number);
    // One of the four may be a polarity in words.
    const auto is_word = [](std::string_view field) {
        return polarity_in_words(field).has_value();
    };
    return numbers == 4 || (numbers == 3 && std::any_of(fields.begin(), fields.end(), is_word));
}

void check_geometry(const Sides& sides) {
    const auto [least, largest] = std::ranges::minmax(sides);
    if (least < 1 || largest > kLargestRecordedSide)
        throw Error(ErrorKind::input,
                    "text recording: expected a sensor's size before the rows, each side from 1 to "
                    "65536, found \"" +
                        std::to_string(sides[0]) + " " + std::to_string(sides[1]) + "\"");
}

struct ColumnName {
    TextField field = TextField::ignored;
    TextTimeUnit unit = TextTimeUnit::automatic;
};

/// What a header row calls a column: "t", "time", "timestamp_us", "t[s]", "x", "pol", ...
ColumnName column_named(std::string_view title) {
    std::string name = lower_case(title);
    std::erase_if(name, [](char c) { return c == '"' || c == '\''; });
    if (name == "x") return {TextField::x, {}};
    if (name == "y") return {TextField::y, {}};
    if (name == "p" || name == "pol" || name == "polarity" || name == "on")
        return {TextField::polarity, {}};
    const std::size_t end = std::min(name.find_first_of(" _[("), name.size());
    const std::string stem = name.substr(0, end);
    if (stem != "t" && stem != "ts" && stem != "time" && stem != "timestamp" &&
        stem != "timestamps")
        return {};
    std::string unit;
    for (const char c : name.substr(end))
        if (std::isalpha(static_cast<unsigned char>(c))) unit += c;
    if (unit.empty()) return {TextField::time, {}};
    if (unit == "s") return {TextField::time, TextTimeUnit::seconds};
    if (unit == "ms") return {TextField::time, TextTimeUnit::milliseconds};
    if (unit == "us") return {TextField::time, TextTimeUnit::microseconds};
    if (unit == "ns") return {TextField::time, TextTimeUnit::nanoseconds};
    return {};
}

/// The titles of a header row; a unit behind a space belongs to the one before: "t [us]".
Fields titles_of(std::string_view line) {
    Fields titles;
    for (const std::string_view field : split_fields(line)) {
        if (!titles.empty() && (field.starts_with('[') || field.starts_with('(')))
            titles.back() = {titles.back().data(),
                             std::size_t(field.data() + field.size() - titles.back().data())};
        else
            titles.push_back(field);
    }
    return titles;
}

/// The layout a header row gives; empty when it does not name all four columns.
std::optional<TextLayout> layout_named(const Fields& titles) {
    TextLayout layout;
    layout.unit = TextTimeUnit::automatic;
    layout.n_columns = 0;
    std::array<int, 4> seen{};
    for (std::size_t i = 0; i < std::min(titles.size(), TextLayout::kMaxColumns); ++i) {
        const ColumnName column = column_named(titles[i]);
        layout.columns[i] = column.field;
        if (column.field == TextField::ignored) continue;
        layout.n_columns = i + 1;
        ++seen[std::size_t(column.field)];
        if (column.field == TextField::time) layout.unit = column.unit;
    }
    const bool once = std::all_of(seen.begin(), seen.end(), [](int n) { return n == 1; });
    return once ? std::optional(layout) : std::nullopt;
}

TextLayout layout_stated(std::string_view columns) {
    TextLayout layout;
    layout.unit = TextTimeUnit::automatic;
    constexpr std::string_view kLetters = "txyp";
    std::string sorted(columns);
    std::sort(sorted.begin(), sorted.end());
    if (sorted != "ptxy")
        throw Error(ErrorKind::usage,
                    "columns of a text recording: expected an order of t, x, y, "
                    "p such as \"txyp\", found \"" +
                        std::string(columns) + "\"");
    for (std::size_t i = 0; i < 4; ++i) layout.columns[i] = TextField(kLetters.find(columns[i]));
    return layout;
}

/// What the rows have in the column of the time.
std::vector<std::string_view> times_in(const std::vector<Fields>& rows, const TextLayout& layout) {
    const auto column =
        std::size_t(std::find(layout.columns.begin(), layout.columns.end(), TextField::time) -
                    layout.columns.begin());
    std::vector<std::string_view> times;
    for (const Fields& row : rows)
        if (column < row.size()) times.push_back(row[column]);
    return times;
}

bool is_printable(std::string_view text) {
    return std::none_of(text.begin(), text.end(), [](char c) {
        const auto code = static_cast<unsigned char>(c);
        return (code < 0x20 && c != '\t' && c != '\r' && c != '\n' && c != '\f') || code == 0x7F;
    });
}

}  // namespace

bool looks_like_text(std::span<const std::byte> first_bytes) {
    const std::string_view text =
        as_text(first_bytes.first(std::min<std::size_t>(first_bytes.size(), 65536)));
    Lines lines(text);
    auto line = lines.next();
    if (!is_printable(text.substr(0, std::min<std::size_t>(text.size(), 512)))) return false;
    if (!line) return lines.size().has_value();
    Fields fields = split_fields(*line);
    if (geometry_of(fields)) {
        line = lines.next();
        if (!line) return true;
        fields = split_fields(*line);
    }
    return is_row(fields) || layout_named(titles_of(*line));
}

TextHeader read_text_header(std::span<const std::byte> first_bytes, const TextOptions& options) {
    TextHeader header;
    header.stream.format = "text";
    Lines lines(as_text(first_bytes));
    auto line = lines.next();
    std::optional<Sides> size;
    if (line) size = geometry_of(split_fields(*line));
    if (size)
        line = lines.next();
    else
        size = lines.size();
    if (size) {
        check_geometry(*size);
        header.stream.width = int((*size)[0]);
        header.stream.height = int((*size)[1]);
    }
    std::optional<TextLayout> named;
    if (line && !is_row(split_fields(*line))) {
        named = layout_named(titles_of(*line));
        if (named) line = lines.next();
    }
    // A recording of no events, as convert writes it, still says its size or its columns.
    const bool says_something = header.stream.width > 0 || named;
    if (line ? !is_row(split_fields(*line)) : !says_something)
        throw Error(ErrorKind::input, "text recording: expected rows \"t x y p\", found " +
                                          (line ? "\"" + std::string(line->substr(0, 60)) + "\""
                                                : std::string("no row of data")));
    header.stream.data_offset = line ? lines.line_begin() : first_bytes.size();

    std::vector<Fields> rows;
    for (; line && rows.size() < kRowsToLookAt; line = lines.next())
        if (Fields fields = split_fields(*line); is_row(fields)) rows.push_back(std::move(fields));

    const TextSensor sensor = size ? TextSensor{(*size)[0], (*size)[1]} : TextSensor{};
    if (!options.columns.empty())
        header.layout = layout_stated(options.columns);
    else
        header.layout = named ? *named : layout_stated(guess_columns(rows, sensor));
    guess_polarities(rows, header.layout);
    if (options.unit != TextTimeUnit::automatic) header.layout.unit = options.unit;
    const auto times = times_in(rows, header.layout);
    if (header.layout.unit == TextTimeUnit::automatic)
        header.layout.unit = guess_time_unit(times, header.remarks);
    else if (options.unit != TextTimeUnit::automatic)
        doubt_time_unit(times, options.unit, header.remarks);
    check_rows(rows, header.layout);
    check_order(rows, header.layout, options.reorder);
    return header;
}

}  // namespace eventide
