// Prophesee's .bias files.
#include "drivers/v4l2/bias_file.h"

#include "src/core/error.h"
#include "src/io/input_file.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <sstream>

namespace eventide {

namespace {

[[noreturn]] void refuse(const std::filesystem::path& file, std::size_t line,
                         const std::string& what) {
    throw Error(ErrorKind::usage, file.string() + ":" + std::to_string(line) + ": " + what);
}

/// What the ioctl takes: 32 bits and a sign.
std::optional<std::int64_t> number_of(const std::string& text) {
    const bool negative = text.starts_with('-');
    std::size_t begin = negative ? 1 : 0;
    const bool hexadecimal = text.compare(begin, 2, "0x") == 0 || text.compare(begin, 2, "0X") == 0;
    if (hexadecimal) begin += 2;
    std::uint32_t value = 0;
    const char* const end = text.data() + text.size();
    const auto [last, error] =
        std::from_chars(text.data() + begin, end, value, hexadecimal ? 16 : 10);
    if (error != std::errc{} || last != end || begin == text.size() || value > INT32_MAX)
        return std::nullopt;
    return negative ? -std::int64_t{value} : std::int64_t{value};
}

Bias bias_of(const std::filesystem::path& file, const std::string& text, std::size_t line) {
    // Metavision pads values to five characters, so that longer ones touch the %.
    const std::size_t percent = std::min(text.find('%'), text.size());
    std::istringstream before{text.substr(0, percent)}, after{text.substr(percent)};
    std::string value, more, separator, name, rest;
    before >> value >> more;
    after >> separator >> name >> rest;
    const auto number = number_of(value);
    if (!number || !more.empty() || separator != "%" || name.empty() ||
        (!rest.empty() && rest != "%"))
        refuse(file, line,
               "expected VALUE % NAME, such as 299 % bias_diff_on, found '" + text + "'");
    return {name, *number, line};
}

}  // namespace

bool names_bias_file(const std::filesystem::path& file) {
    return file.extension() == ".bias";
}

std::vector<Bias> read_bias_file(const std::filesystem::path& file) {
    constexpr std::size_t kMaxBiases = 1000;
    std::ifstream stream = open_to_read(file, ErrorKind::usage);
    std::vector<Bias> biases;
    std::size_t line = 0;
    for (std::string text; std::getline(stream, text);) {
        ++line;
        while (!text.empty() && (text.back() == '\r' || text.back() == ' ')) text.pop_back();
        const std::size_t begin = text.find_first_not_of(" \t");
        if (begin == text.npos || text[begin] == '%') continue;
        const Bias bias = bias_of(file, text, line);
        const auto before = std::ranges::find(biases, bias.name, &Bias::name);
        if (before == biases.end())
            biases.push_back(bias);
        else if (before->value != bias.value)
            refuse(file, line,
                   "'" + bias.name + "' is " + std::to_string(bias.value) + " here, and " +
                       std::to_string(before->value) + " in line " + std::to_string(before->line));
        if (biases.size() > kMaxBiases) refuse(file, line, "expected at most 1000 biases");
    }
    if (biases.empty()) refuse(file, line, "expected lines of VALUE % NAME, found none");
    return biases;
}

}  // namespace eventide
