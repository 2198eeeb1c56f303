// A small YAML file as a tree: calibrations.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace eventide {

struct YamlNode {
    enum class Kind { scalar, list, map };

    Kind kind = Kind::scalar;
    std::string text;               ///< of a scalar
    std::vector<YamlNode> items;    ///< of a list; of a map its values, in the file's order
    std::vector<std::string> keys;  ///< of a map, one for each item
    std::size_t line = 0;           ///< from 1

    /// Null where there is none.
    const YamlNode* find(std::string_view key) const;
};

/// The first document. Throws Error (input) with the line for what is no YAML, and for a file of
/// more than 10,000 nodes or 32 levels.
YamlNode read_yaml(const std::filesystem::path& file);

}  // namespace eventide
