// Latent maps without an encoder, and configurations of the renderer that reads them.
#pragma once

#include "src/core/frame_data.h"
#include "src/model/engine.h"
#include "tests/model/streams.h"

#include <cstdint>
#include <random>

namespace eventide::test {

inline ModelConfig config_of(int stride) {
    ModelConfig config = small_config();
    config.latent_stride = stride;
    return config;
}

/// A renderer that reads codes in time alone, and whose live edge fades.
inline ModelConfig fading_config() {
    ModelConfig config = small_config();
    config.unfold = 1;
    config.live_edge = LiveEdge::fade;
    return config;
}

/// Of the k-th event window.
inline LatentMap random_latent(const ModelConfig& config, int height, int width, int k) {
    const int s = config.latent_stride;
    LatentMap latent;
    latent.values = {(height + s - 1) / s, (width + s - 1) / s, config.latent};
    std::mt19937 random{100 + std::uint32_t(k)};
    for (float& v : latent.values.values()) v = float(random() % 2001) / 1000 - 1;
    // Windows of unequal width: 50, 60, 70 ms ...
    const auto edge = [](int n) { return from_us(1'000'000 + 50'000 * n + 5'000 * n * n); };
    latent.window = {edge(k - 1), edge(k)};
    latent.events = std::uint64_t(k);
    return latent;
}

inline EngineOptions with(Engine engine) {
    EngineOptions options;
    options.engine = engine;
    options.precision = Precision::f32;
    return options;
}

}  // namespace eventide::test
