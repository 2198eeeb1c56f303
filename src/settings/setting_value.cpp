// What is refused, and how that is said.
#include "src/settings/setting_value.h"

#include "src/core/error.h"
#include "src/core/number_text.h"
#include "src/core/text_piece.h"

#include <limits>

namespace eventide {

namespace {

/// As it stands in the file; of a command line in quotes.
std::string shown(const SettingValue& value) {
    if (value.place.empty() || value.kind == ValueKind::text)
        return "'" + piece_of(value.text) + "'";
    if (value.kind == ValueKind::list) return "a list of " + std::to_string(value.items.size());
    return value.text.empty() ? name_of(value.kind) : value.text;
}

}  // namespace

std::string name_of(ValueKind kind) {
    switch (kind) {
        case ValueKind::text:
            return "text";
        case ValueKind::number:
            return "a number";
        case ValueKind::flag:
            return "true or false";
        case ValueKind::list:
            return "a list of texts";
        case ValueKind::table:
            return "a table";
        case ValueKind::date:
            return "a date or time of day";
    }
    return {};
}

SettingValue::SettingValue(const std::vector<std::string>& words)
    : kind{ValueKind::list}, items(words.begin(), words.end()) {
    if (!words.empty()) text = words.back();
}

std::vector<std::string> SettingValue::texts() const {
    if (kind != ValueKind::list) return {text};
    std::vector<std::string> all;
    for (const SettingValue& item : items) all.push_back(item.text);
    return all;
}

void SettingValue::refuse(const std::string& expected) const {
    throw Error(ErrorKind::usage, (place.empty() ? "" : place + ": " + name + ": ") + "expected " +
                                      expected + ", found " + shown(*this));
}

std::int64_t whole_of(const SettingValue& value, std::int64_t least, std::int64_t most) {
    const auto whole =
        value.may_be(ValueKind::number) ? number_in<std::int64_t>(value.text) : std::nullopt;
    if (whole && *whole >= least && *whole <= most) return *whole;
    const bool endless = least >= 0 && most == std::numeric_limits<int>::max();
    value.refuse("a whole number from " + std::to_string(least) +
                 (endless ? " up" : " to " + std::to_string(most)));
}

}  // namespace eventide
