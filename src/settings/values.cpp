// Text into values.
#include "src/settings/values.h"

#include "src/core/duration_text.h"
#include "src/core/error.h"
#include "src/core/number_text.h"
#include "src/core/text_piece.h"
#include "src/settings/setting_value.h"

#include <eventide/frame.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <system_error>

namespace eventide {

void throw_usage(const std::string& expected, const std::string& found) {
    throw Error(ErrorKind::usage, "expected " + expected + ", found '" + piece_of(found) + "'");
}

int parse_whole(const std::string& text, int least, int most) {
    return int(whole_of(text, least, most));
}

double parse_number(const std::string& text, double least, double most) {
    const auto value = number_in<double>(text);
    if (!value || !(*value >= least && *value <= most))
        throw_usage("a number from " + show_number(least) + " to " + show_number(most), text);
    return *value;
}

std::string show_number(double value) {
    // 100000, not 1e+05, as long as it stays short.
    constexpr std::size_t kShort = 16;
    std::array<char, 32> text{};
    const auto fixed =
        std::to_chars(text.data(), text.data() + kShort, value, std::chars_format::fixed);
    if (fixed.ec == std::errc{}) return {text.data(), fixed.ptr};
    const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc{} ? std::string{text.data(), end} : "?";
}

const std::string& parse_choice(const std::string& text, const std::vector<std::string>& names) {
    if (std::ranges::find(names, text) == names.end()) throw_usage(alternatives(names), text);
    return text;
}

SensorDuration parse_duration(const std::string& text, bool negative) {
    const auto found = read_duration(text);
    if (!found && number_in<double>(text))
        throw_usage("a time with its unit, " + text + "s, " + text + "ms or " + text + "us", text);
    if (!found || (found->count() < 0 && !negative))
        throw_usage("a time such as 1.5s, 20ms or 250us", text);
    return *found;
}

std::string show_duration(SensorDuration duration) {
    return duration_text(duration);
}

Size parse_size(const std::string& text) {
    constexpr int kMax = kLargestFrameSide;
    const auto [width, height] = size_in(text).value_or(std::pair{0, 0});
    if (width < 1 || height < 1 || width > kMax || height > kMax)
        throw_usage("a size such as 640x480, each from 1 to " + std::to_string(kMax), text);
    return {width, height};
}

std::string show_size(const Size& size) {
    return std::to_string(size.width) + "x" + std::to_string(size.height);
}

}  // namespace eventide
