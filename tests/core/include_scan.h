// The #include lines of the project's sources.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace eventide {

struct Include {
    std::string file;    ///< relative to the project's root
    std::string target;  ///< between the quotes or brackets
};

/// The target of an #include line, or empty.
inline std::string include_target(std::string_view line) {
    const auto start = line.find_first_not_of(" \t");
    if (start == line.npos || !line.substr(start).starts_with("#include")) return {};
    const auto open = line.find_first_of("<\"", start);
    if (open == line.npos) return {};
    const auto close = line.find_first_of(">\"", open + 1);
    return close == line.npos ? "" : std::string{line.substr(open + 1, close - open - 1)};
}

inline std::vector<Include> includes_below(const std::vector<std::string>& folders) {
    namespace fs = std::filesystem;
    std::vector<Include> found;
    const fs::path root{EVENTIDE_SOURCE_DIR};
    for (const std::string& folder : folders)
        for (const auto& entry : fs::recursive_directory_iterator{root / folder}) {
            const auto extension = entry.path().extension();
            if (extension != ".h" && extension != ".cpp" && extension != ".hpp" &&
                extension != ".inl" && extension != ".c")
                continue;
            std::ifstream file{entry.path()};
            for (std::string line; std::getline(file, line);)
                if (std::string target = include_target(line); !target.empty())
                    found.push_back({fs::relative(entry.path(), root).string(), target});
        }
    return found;
}

}  // namespace eventide
