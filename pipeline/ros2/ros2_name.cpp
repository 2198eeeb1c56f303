// Keys and values of a ROS 2 sink's name.
#include "pipeline/ros2/ros2_name.h"

#include "src/core/error.h"
#include "src/core/number_text.h"
#include "src/settings/words.h"

#include <algorithm>
#include <cstddef>

namespace eventide {

namespace {

const std::vector<Word<ImageEncoding>> kEncodings{{ImageEncoding::mono8, "mono8"},
                                                  {ImageEncoding::mono16, "mono16"},
                                                  {ImageEncoding::float32, "32FC1"}};
const std::vector<Word<ImageCompression>> kCompressions{{ImageCompression::none, "none"},
                                                        {ImageCompression::jpeg, "jpeg"},
                                                        {ImageCompression::png, "png"}};
const std::vector<Word<StampRule>> kStampRules{
    {StampRule::automatic, "auto"}, {StampRule::sensor, "sensor"}, {StampRule::arrival, "arrival"}};
const std::vector<Word<bool>> kAnswers{{false, "no"}, {true, "yes"}};
constexpr int kMaxSubscribers = 1000;

[[noreturn]] void refuse(const std::string& key, const std::string& expected,
                         const std::string& found) {
    throw Error(ErrorKind::usage,
                "ros2: " + key + ": expected " + expected + ", found '" + found + "'");
}

template <typename Enum>
Enum choose(const std::string& key, const std::vector<Word<Enum>>& words, const std::string& text) {
    if (const auto value = find_word(text, words)) return *value;
    refuse(key, alternatives(texts_of(words)), text);
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
        name.encoding = choose(key, kEncodings, value);
    else if (key == "uncertainty")
        name.uncertainty = choose(key, kEncodings, value);
    else if (key == "compressed")
        name.compressed = choose(key, kCompressions, value);
    else if (key == "calibration")
        name.calibration = filled(key, value);
    else if (key == "calibration_camera")
        name.calibration_camera = filled(key, value);
    else if (key == "frame_id")
        name.frame_id = filled(key, value);
    else if (key == "lazy")
        name.lazy = choose(key, kAnswers, value);
    else if (key == "subscribers")
        name.subscribers = subscribers(value);
    else if (key == "stamp")
        name.stamp = choose(key, kStampRules, value);
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
               show_word(name.compressed, kCompressions) + " of " + name_of(name.encoding));
}

bool is_letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

}  // namespace

std::string name_of(ImageEncoding encoding) {
    return show_word(encoding, kEncodings);
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
