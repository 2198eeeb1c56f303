// Opening a file to read it, and reading all of it.
#pragma once

#include "src/core/error.h"

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace eventide {

/// Throws Error with the system's words: of `kind` where there is no such file, failed where the
/// process has run out of descriptors, which says nothing about the file.
std::ifstream open_to_read(const std::filesystem::path& path, ErrorKind kind = ErrorKind::input);

/// What people write by hand is far smaller; what never ends (/dev/zero) is larger.
constexpr std::size_t kLargestText = std::size_t{4} << 20;

/// All of a text file, or of a pipe. Throws as open_to_read(), and Error of `kind` where there is
/// more than `most_bytes`.
std::string read_text_file(const std::filesystem::path& path, ErrorKind kind = ErrorKind::input,
                           std::size_t most_bytes = kLargestText);

/// All of a file of numbers. Throws Error (input), also for what is no regular file.
std::vector<std::byte> read_bytes_of_file(const std::filesystem::path& path);

}  // namespace eventide
