// Reads a camera's TOML settings: every key known, every value in range, refused with file and
// line.
#pragma once

#include "src/core/error.h"

#include <toml++/toml.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <string>
#include <vector>

namespace eventide {

/// Say which keys there are and where they go, then read(). All refusals are Error (usage).
class SettingsFile {
public:
    explicit SettingsFile(std::filesystem::path file);

    void flag(const char* name, bool& into);
    void number(const char* name, int& into, std::int64_t least, std::int64_t most);
    void choice(const char* name, int& into, std::initializer_list<int> allowed);
    void custom(const char* name, std::function<void(const toml::node&)> take);

    /// Takes every key of the file; a key nobody asked for is refused.
    void read();

    /// A whole number from a node that `name` stands for.
    std::int64_t checked(const toml::node& node, const std::string& name, std::int64_t least,
                         std::int64_t most) const;
    [[noreturn]] void refuse(const toml::node& node, const std::string& what) const;

private:
    struct Key {
        std::string name;
        std::function<void(const toml::node&)> take;
    };
    std::filesystem::path file_;
    toml::table table_;
    std::vector<Key> keys_;
};

}  // namespace eventide
