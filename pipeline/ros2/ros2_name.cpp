// Keys and values of a ROS 2 sink's name.
#include "pipeline/ros2/ros2_name.h"

#include "src/core/error.h"
#include "src/core/number_text.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace eventide {

namespace {

constexpr std::array<std::string_view, 3> kEncodings{"mono8", "mono16", "32FC1"};
constexpr std::array<std::string_view, 3> kCompressions{"none", "jpeg", "png"};
constexpr std::array<std::string_view, 3> kStampRules{"auto", "sensor", "arrival"};
constexpr std::array<std::string_view, 2> kAnswers{"no", "yes"};
constexpr int kMaxSubscribers = 1000;

[[noreturn]] void refuse(const std::string& key, const std::string& expected,
                         const std::string& found) {
    throw Error(ErrorKind::usage,
                "ros2: " + key + ": expected " + expected + ", found '" + found + "'");
}

template <std::size_t kSize>
std::size_t choose(const std::string& key, const std::array<std::string_view, kSize>& names,
                   const std::string& text) {
    const auto found = std::ranges::find(names, text);
    if (found != names.end()) return std::size_t(found - names.begin());
    std::string expected{names[0]};
    for (std::size_t i = 1; i < kSize; ++i)
        expected += (i + 1 == kSize ? " or " : ", ") + std::string{names[i]};
    refuse(key, expected, text);
}

int subscribers(const std::string& text) {
    const int value = number_in<int>(text).value_or(-1);
    if (value < 0 || value > kMaxSubscribers)
        refuse("subscribers", "0 to " + std::to_string(kMaxSubscribers), text);
    return value;
}

const std::string& filled(const std::string& key, const std::string& text) {
    if (text.empty()) refuse(key, "a value", text);
    return text;
}

void set(Ros2SinkName& name, const std::string& key, const std::string& value) {
    if (key == "encoding")
        name.encoding = ImageEncoding(choose(key, kEncodings, value));
    else if (key == "uncertainty")
        name.uncertainty = ImageEncoding(choose(key, kEncodings, value));
    else if (key == "compressed")
        name.compressed = ImageCompression(choose(key, kCompressions, value));
    else if (key == "calibration")
        name.calibration = filled(key, value);
    else if (key == "calibration_camera")
        name.calibration_camera = filled(key, value);
    else if (key == "frame_id")
        name.frame_id = filled(key, value);
    else if (key == "lazy")
        name.lazy = choose(key, kAnswers, value) == 1;
    else if (key == "subscribers")
        name.subscribers = subscribers(value);
    else if (key == "stamp")
        name.stamp = StampRule(choose(key, kStampRules, value));
    else
        refuse("key",
               "encoding, uncertainty, compressed, calibration, calibration_camera, frame_id, "
               "lazy, subscribers or stamp",
               key);
}

void check_compression(const Ros2SinkName& name) {
    const bool fits =
        name.compressed == ImageCompression::none || name.encoding == ImageEncoding::mono8 ||
        (name.compressed == ImageCompression::png && name.encoding == ImageEncoding::mono16);
    if (!fits)
        refuse("compressed",
               "jpeg of mono8, or png of mono8 or mono16, as nothing else can be "
               "compressed",
               std::string{kCompressions[std::size_t(name.compressed)]} + " of " +
                   std::string{name_of(name.encoding)});
}

bool is_letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

}  // namespace

std::string_view name_of(ImageEncoding encoding) {
    return kEncodings[std::size_t(encoding)];
}

KeyedName split_keys(const std::string& name) {
    KeyedName split;
    const std::size_t mark = name.find('?');
    split.path = name.substr(0, mark);
    for (std::size_t at = mark; at != name.npos;) {
        const std::size_t begin = at + 1;
        at = name.find('&', begin);
        const std::string item = name.substr(begin, at == name.npos ? at : at - begin);
        const std::size_t equals = item.find('=');
        if (equals == item.npos) refuse("key", "KEY=VALUE", item);
        split.keys.emplace_back(item.substr(0, equals), item.substr(equals + 1));
    }
    return split;
}

void check_ros2_name(std::string_view what, std::string_view name) {
    char before = 0;
    bool good = name.starts_with('/') && !name.ends_with('/');
    for (const char c : name) {
        if (c == '/' || (is_digit(c) && before == '/')) good = good && before != '/';
        good = good && (c == '/' || is_letter(c) || is_digit(c));
        before = c;
    }
    if (!good)
        refuse(std::string{what}, "a name such as /camera (letters, digits, _ and /)",
               std::string{name});
}

Ros2SinkName parse_ros2_sink_name(const std::string& text) {
    const KeyedName split = split_keys(text);
    Ros2SinkName name;
    if (split.path != "/") {
        check_ros2_name("name space", split.path);
        name.name_space = split.path;
    }
    for (const auto& [key, value] : split.keys) set(name, key, value);
    check_compression(name);
    if (name.frame_id.empty())
        name.frame_id =
            name.name_space.empty() ? "camera" : split.path.substr(split.path.rfind('/') + 1);
    return name;
}

}  // namespace eventide
