// What may be made or replaced under a name.
#pragma once

#include "src/core/error.h"

#include <filesystem>
#include <optional>
#include <string>

namespace eventide {

/// Throws Error (usage) when `path` is empty, a folder, or a file with something in it and
/// `overwrite` is not set: for a word early in long work, since OutputFile asks again.
void refuse_existing(const std::filesystem::path& path, bool overwrite);

/// Whether there is a file with something in it, which OutputFile would replace.
bool would_replace(const std::filesystem::path& path);

/// Whether the path stands for a file that is open already: "-", /dev/stdout, /dev/fd/3.
bool names_open_file(const std::filesystem::path& path);

/// A folder and those above it; false where it exists already. Throws Error (failed) with the
/// system's words.
bool create_folder(const std::filesystem::path& path);

/// Which one names_open_file() means: what was written to it before, by whomever, stays.
std::optional<int> descriptor_named(const std::filesystem::path& path);

/// "-", /dev/stdout or /dev/fd/1.
bool is_standard_output(const std::filesystem::path& path);

/// The Error (usage) for a file that is not to be replaced.
Error existing_file(const std::string& name);

}  // namespace eventide
