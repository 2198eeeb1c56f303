#include "drivers/settings_file.h"

#include "src/io/toml_text.h"

#include <algorithm>

namespace eventide {
namespace {

Error refusal(const std::filesystem::path& file, const toml::source_region& where,
              std::string_view what) {
    return {ErrorKind::usage,
            file.string() + ":" + std::to_string(where.begin.line) + ": " + std::string{what}};
}

toml::table parse(const std::filesystem::path& file) {
    if (!std::filesystem::is_regular_file(file))
        throw Error(ErrorKind::usage, "camera settings '" + file.string() + "': no such file");
    if (file.extension() == ".bias")
        throw Error(ErrorKind::usage, "camera settings '" + file.string() +
                                          "': expected TOML as in config/cameras, found a .bias "
                                          "file of Prophesee's, which is for v4l2: cameras");
    const std::string text = read_toml_text(file);
    try {
        return toml::parse(text, file.string());
    } catch (const toml::parse_error& error) {
        throw refusal(file, error.source(), error.description());
    }
}

}  // namespace

SettingsFile::SettingsFile(std::filesystem::path file)
    : file_(std::move(file)), table_(parse(file_)) {}

void SettingsFile::refuse(const toml::node& node, const std::string& what) const {
    throw refusal(file_, node.source(), what);
}

std::int64_t SettingsFile::checked(const toml::node& node, const std::string& name,
                                   std::int64_t least, std::int64_t most) const {
    const auto value = node.value_exact<std::int64_t>();
    if (!value || *value < least || *value > most)
        refuse(node, name + ": expected a whole number from " + std::to_string(least) + " to " +
                         std::to_string(most) +
                         (value ? ", found " + std::to_string(*value) : std::string{}));
    return *value;
}

void SettingsFile::custom(const char* name, std::function<void(const toml::node&)> take) {
    keys_.push_back({name, std::move(take)});
}

void SettingsFile::flag(const char* name, bool& into) {
    custom(name, [this, name, &into](const toml::node& node) {
        const auto value = node.value_exact<bool>();
        if (!value) refuse(node, std::string{name} + ": expected true or false");
        into = *value;
    });
}

void SettingsFile::number(const char* name, int& into, std::int64_t least, std::int64_t most) {
    custom(name, [this, name, &into, least, most](const toml::node& node) {
        into = int(checked(node, name, least, most));
    });
}

void SettingsFile::choice(const char* name, int& into, std::initializer_list<int> allowed) {
    custom(name, [this, name, &into, all = std::vector<int>(allowed)](const toml::node& node) {
        const std::int64_t value = checked(node, name, INT32_MIN, INT32_MAX);
        if (std::find(all.begin(), all.end(), int(value)) != all.end()) {
            into = int(value);
            return;
        }
        std::string text;
        for (const int a : all) text += (text.empty() ? "" : ", ") + std::to_string(a);
        refuse(node, std::string{name} + ": expected one of " + text + ", found " +
                         std::to_string(value));
    });
}

void SettingsFile::read() {
    for (const auto& [name, node] : table_) {
        const std::string wanted{name.str()};
        const auto key = std::find_if(keys_.begin(), keys_.end(),
                                      [&](const Key& k) { return k.name == wanted; });
        if (key == keys_.end()) refuse(node, "unknown key '" + wanted + "'");
        key->take(node);
    }
}

}  // namespace eventide
