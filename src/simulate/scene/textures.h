// The textures that scenes are drawn from.
#pragma once

#include "src/simulate/scene/texture.h"

#include <memory>
#include <string>
#include <vector>

namespace eventide {

using GreyImage = Array2<std::uint8_t>;  ///< [y][x], gamma-encoded as image files are

/// Read only once made: any number of streams on any threads may share one.
class TextureLibrary {
public:
    void add(const GreyImage& image) { textures_.emplace_back(image); }
    std::size_t size() const { return textures_.size(); }
    bool empty() const { return textures_.empty(); }
    const Texture& operator[](std::size_t i) const { return textures_[i]; }

private:
    std::vector<Texture> textures_;
};

/// Noise of many scales, checkers, bars, lines of text-like blobs, heaps of polygons, in turn:
/// image i of a seed is always the same. `side` in px.
GreyImage procedural_image(std::size_t i, int side, std::uint64_t seed);
std::shared_ptr<TextureLibrary> procedural_textures(std::size_t count, int side = 256,
                                                    std::uint64_t seed = 1);

}  // namespace eventide
