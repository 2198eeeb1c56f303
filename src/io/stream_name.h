// What "-" is called to people.
#pragma once

#include <string>

namespace eventide {

/// The name of an input in messages: "standard input" for "-", else the path as it is.
inline std::string input_name(const std::string& path) {
    return path == "-" ? "standard input" : path;
}

/// The name of an output in messages: "standard output" for "-", else the path as it is.
inline std::string output_name(const std::string& path) {
    return path == "-" ? "standard output" : path;
}

}  // namespace eventide
