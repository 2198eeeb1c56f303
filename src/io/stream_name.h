// What "-" is called to people.
#pragma once

#include <string>

namespace eventide {

/// Of what is read: "standard input", or the path as it is.
inline std::string input_name(const std::string& path) {
    return path == "-" ? "standard input" : path;
}

/// Of what is written: "standard output", or the path as it is.
inline std::string output_name(const std::string& path) {
    return path == "-" ? "standard output" : path;
}

}  // namespace eventide
