// Opening a file to read it.
#pragma once

#include "src/core/error.h"

#include <filesystem>
#include <fstream>

namespace eventide {

/// Throws Error with the system's words: of `kind` where there is no such file, failed where the
/// process has run out of descriptors, which says nothing about the file.
std::ifstream open_to_read(const std::filesystem::path& path, ErrorKind kind = ErrorKind::input);

}  // namespace eventide
