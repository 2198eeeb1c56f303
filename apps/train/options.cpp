#include "apps/train/options.h"

#include "src/core/error.h"

#include <algorithm>

namespace eventide {

void OptionTable::set(const std::string& name, const std::string& value) {
    // A checkpoint records a line for each.
    if (value.find('\n') != value.npos)
        throw Error(ErrorKind::usage, "--" + name + ": expected one line, found more");
    for (const Option& option : options_)
        if (option.setting.key == name) return set_from("--" + name, option.setting, value);
    throw Error(ErrorKind::usage, "expected one of the options of --help, found '--" + name + "'");
}

void OptionTable::parse(const std::vector<std::string>& words) {
    for (std::size_t i = 0; i < words.size(); i += 2) {
        if (!words[i].starts_with("--"))
            throw Error(ErrorKind::usage, "expected --NAME, found '" + words[i] + "'");
        if (i + 1 == words.size())
            throw Error(ErrorKind::usage, words[i] + ": expected a value, found none");
        set(words[i].substr(2), words[i + 1]);
    }
}

std::string OptionTable::help() const {
    std::string text = "eventide-train [--NAME VALUE]...\n";
    for (const Option& option : options_) {
        std::string line = "  " + flag_of(option.setting) + " ";
        line.resize(std::max<std::size_t>(line.size(), 24), ' ');
        text += line + option.setting.help + " (" + option.value() + ")\n";
    }
    return text;
}

std::string OptionTable::record() const {
    std::string text;
    for (const Option& option : options_)
        if (option.use != Use::once && !option.value().empty())
            text += flag_of(option.setting) + " " + option.value() + "\n";
    return text;
}

std::string OptionTable::settings() const {
    std::string text;
    for (const Option& option : options_)
        if (option.use == Use::learning && !option.value().empty())
            text += (text.empty() ? "" : " ") + flag_of(option.setting) + " " + option.value();
    return text;
}

}  // namespace eventide
