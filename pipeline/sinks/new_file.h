// The one rule about files that exist already: they are kept unless the user says otherwise.
#pragma once

#include <filesystem>

namespace eventide {

/// Throws Error (usage) when `path` is a folder, or a file with something in it and `overwrite` is
/// not set. Pipes and devices are written to, not overwritten: they pass.
void refuse_existing(const std::filesystem::path& path, bool overwrite);

}  // namespace eventide
