// Many grey images in one small file, without loss: what training carries to another machine.
#pragma once

#include "src/simulate/scene/textures.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace eventide {

/// The file: "EVTEXTURES1\n", then the number of images as 32 bits little endian, then per image
/// width, height and length of its code in bytes (32 bits each), and the code. Each pixel is told
/// as its difference from the median of left, above and left + above - above-left (LOCO-I,
/// Weinberger et al. 2000), in adaptive Golomb-Rice codes, most significant bit first: about half
/// of raw for photographs. Throws Error (input) for a file that is not such a pack or is damaged,
/// (failed) for one that cannot be written.
void write_texture_pack(const std::filesystem::path& file, const std::vector<GreyImage>& images);
std::vector<GreyImage> read_texture_pack(const std::filesystem::path& file);

/// The textures of a pack; `keep(i)` chooses images by number (all, where empty).
std::shared_ptr<TextureLibrary> textures_from_pack(
    const std::filesystem::path& file, const std::function<bool(std::size_t)>& keep = {});

/// Shrunk by area means until neither side is longer than `longest`; smaller images stay.
GreyImage shrunk(const GreyImage& image, int longest);

}  // namespace eventide
