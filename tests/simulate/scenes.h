// Scenes of procedural textures, as tests look at them.
#pragma once

#include "src/simulate/scene/scene.h"
#include "src/simulate/scene/textures.h"

#include <cstdint>

namespace eventide::test {

inline Scene make_scene(const SceneSettings& settings, std::uint64_t seed, int width = 48,
                        int height = 36) {
    static const auto kTextures = procedural_textures(10, 128);
    Scene scene{settings, kTextures, width, height, Random{seed}};
    scene.prepare(10);
    return scene;
}

}  // namespace eventide::test
