// Many grey pictures in one file: binary PGM (netpbm "P5"), one after the other.
#pragma once

#include "src/simulate/textures.h"

#include <filesystem>
#include <memory>

namespace eventide {

/// Throws Error(input) naming the file, what was expected and where something else was found.
std::shared_ptr<TextureLibrary> load_picture_pack(const std::filesystem::path& path);

}  // namespace eventide
