// Prophesee's files of biases.
#include "drivers/v4l2/bias_file.h"

#include "src/core/error.h"
#include "src/core/number_text.h"
#include "src/core/text_piece.h"
#include "src/io/input_file.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <optional>
#include <sstream>
#include <string_view>

namespace eventide {

namespace {

constexpr std::size_t kMaxBiases = 1000, kMaxBytes = std::size_t{1} << 20, kMaxName = 100;
constexpr int kMaxDepth = 16;  // of JSON, which is printed recursively

[[noreturn]] void refuse(const std::string& place, const std::string& what) {
    throw Error(ErrorKind::usage, place + ": " + what);
}

std::string text_in(const std::filesystem::path& file) {
    return read_text_file(file, ErrorKind::usage, kMaxBytes);
}

void add(const BiasLine& bias, std::vector<BiasLine>& to) {
    if (bias.name.size() > kMaxName)
        refuse(bias.place,
               "expected a name of at most 100 characters, found '" + piece_of(bias.name) + "'");
    const auto before = std::ranges::find(to, bias.name, &BiasLine::name);
    if (before == to.end())
        to.push_back(bias);
    else if (before->value != bias.value)
        refuse(bias.place, "'" + bias.name + "' is " + std::to_string(bias.value) + " here, and " +
                               std::to_string(before->value) + " in " + before->place);
    if (to.size() > kMaxBiases) refuse(bias.place, "expected at most 1000 biases");
}

/// What the ioctl takes: 32 bits and a sign.
std::optional<std::int64_t> number_of(const std::string& text) {
    const bool negative = text.starts_with('-');
    std::size_t begin = negative ? 1 : 0;
    const bool hexadecimal = text.compare(begin, 2, "0x") == 0 || text.compare(begin, 2, "0X") == 0;
    if (hexadecimal) begin += 2;
    const std::string_view digits = std::string_view{text}.substr(begin);
    const auto value =
        hexadecimal ? hex_number_in<std::uint32_t>(digits) : number_in<std::uint32_t>(digits);
    if (!value || *value > INT32_MAX) return std::nullopt;
    return negative ? -std::int64_t{*value} : std::int64_t{*value};
}

BiasLine bias_of(const std::string& place, const std::string& text) {
    // Metavision pads values to five characters, so that longer ones touch the %.
    const std::size_t percent = std::min(text.find('%'), text.size());
    std::istringstream before{text.substr(0, percent)}, after{text.substr(percent)};
    std::string value, more, separator, name, rest;
    before >> value >> more;
    after >> separator >> name >> rest;
    const auto number = number_of(value);
    if (!number || !more.empty() || separator != "%" || name.empty() ||
        (!rest.empty() && rest != "%"))
        refuse(place,
               "expected VALUE % NAME, such as 299 % bias_diff_on, found '" + piece_of(text) + "'");
    return {name, *number, place};
}

std::vector<BiasLine> read_lines(const std::filesystem::path& file) {
    std::istringstream stream{text_in(file)};
    std::vector<BiasLine> biases;
    std::size_t line = 0;
    for (std::string text; std::getline(stream, text);) {
        ++line;
        while (!text.empty() && (text.back() == '\r' || text.back() == ' ')) text.pop_back();
        const std::size_t begin = text.find_first_not_of(" \t");
        if (begin == text.npos || text[begin] == '%') continue;
        add(bias_of(file.string() + ":" + std::to_string(line), text), biases);
    }
    if (biases.empty()) refuse(file.string(), "expected lines of VALUE % NAME, found none");
    return biases;
}

using Json = nlohmann::json;

/// proto3's JSON may leave out a value of 0.
BiasLine bias_of(const Json& each, const std::string& place) {
    const bool named = each.is_object() && each.contains("name") && each["name"].is_string() &&
                       !each["name"].get_ref<const std::string&>().empty();
    const Json value = each.is_object() ? each.value("value", Json(0)) : Json();
    const bool whole = value.is_number_integer() &&
                       (!value.is_number_unsigned() || value.get<std::uint64_t>() <= INT32_MAX) &&
                       value.get<std::int64_t>() >= INT32_MIN;
    if (!named || !whole)
        refuse(place, R"(expected {"name": "bias_fo", "value": 0} with a whole number, found )" +
                          piece_of(each.dump()));
    return {each["name"].get<std::string>(), value.get<std::int64_t>(), place};
}

Json json_in(const std::filesystem::path& file) {
    const auto watch = [&](int depth, Json::parse_event_t, Json&) {
        if (depth > kMaxDepth)
            refuse(file.string(), "expected JSON of at most 16 levels, found more");
        return true;
    };
    try {
        return Json::parse(text_in(file), watch);
    } catch (const Json::exception& error) {
        refuse(file.string(), "expected JSON: " + piece_of(error.what()));
    }
}

std::vector<BiasLine> read_json(const std::filesystem::path& file) {
    const Json root = json_in(file);
    const Json* state =
        root.is_object() && root.contains("ll_biases_state") ? &root["ll_biases_state"] : nullptr;
    if (state == nullptr || !state->is_object() || !state->contains("bias") ||
        !(*state)["bias"].is_array() || (*state)["bias"].empty())
        refuse(file.string(),
               "expected camera settings of Metavision with ll_biases_state.bias, a list of biases "
               "with name and value, found none");
    std::vector<BiasLine> biases;
    const Json& list = (*state)["bias"];
    for (std::size_t i = 0; i < list.size(); ++i)
        add(bias_of(list[i], file.string() + ": ll_biases_state.bias[" + std::to_string(i) + "]"),
            biases);
    return biases;
}

}  // namespace

bool names_bias_file(const std::filesystem::path& file) {
    return file.extension() == ".bias" || file.extension() == ".json";
}

std::vector<BiasLine> read_bias_file(const std::filesystem::path& file) {
    return file.extension() == ".json" ? read_json(file) : read_lines(file);
}

}  // namespace eventide
