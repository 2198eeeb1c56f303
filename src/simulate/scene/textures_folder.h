// Images of a folder as textures. Apart from the rest because it alone needs OpenCV
// (eventide::simulate_images).
#pragma once

#include "src/simulate/scene/textures.h"

#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <vector>

namespace eventide {

/// Image files (png, jpg, jpeg, bmp, tif, tiff, webp, pgm) below a folder, sorted by path.
/// Throws Error (input) where there are none.
std::vector<std::filesystem::path> image_files(const std::filesystem::path& folder);

/// Grey, as stored (gamma-encoded). Throws Error (input) for a file that is no image.
GreyImage read_grey_image(const std::filesystem::path& file);

/// The same of each colour: blue, green, red.
std::array<GreyImage, 3> read_colour_image(const std::filesystem::path& file);

/// All images of a folder, of which each library holds one colour: blue, green, red.
std::array<std::shared_ptr<const TextureLibrary>, 3> colour_textures_from_folder(
    const std::filesystem::path& folder, int longest = 1024);

/// All images of a folder; longer sides than `longest` px are shrunk, 0 leaves them.
std::shared_ptr<TextureLibrary> textures_from_folder(const std::filesystem::path& folder,
                                                     int longest = 1024);

/// Of a recording: as many as give a scene of 30 objects little repetition.
inline constexpr std::size_t kProceduralTextures = 48;

/// What a user names: a folder of images, a pack (texture_pack.h), or nothing, which gives
/// `procedural` made-up ones. Throws Error (input).
std::shared_ptr<const TextureLibrary> open_textures(const std::filesystem::path& path,
                                                    std::size_t procedural);

}  // namespace eventide
