// One picture for all that a scene shows.
#pragma once

#include "src/simulate/scene/textures.h"

#include <memory>

namespace eventide::test {

inline std::shared_ptr<const TextureLibrary> textures_of(const GreyImage& image) {
    auto textures = std::make_shared<TextureLibrary>();
    textures->add(image);
    return textures;
}

/// What is seen of it are the edges of things.
inline std::shared_ptr<const TextureLibrary> one_grey() {
    return textures_of(GreyImage(16, 16));
}

}  // namespace eventide::test
