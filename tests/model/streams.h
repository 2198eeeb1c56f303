// Voxel grids like a camera's: activity that moves about, pauses, bursts and hot pixels.
#pragma once

#include "src/core/frame_data.h"
#include "src/model/model_file.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

namespace eventide::test {

/// Event windows of 50 ms with a patch of activity that wanders, sometimes nothing, sometimes
/// everywhere. The same seed gives the same stream.
class GridStream {
public:
    GridStream(const ModelConfig& config, int height, int width, std::uint32_t seed)
        : bins_(config.bins), random_(seed) {
        grid_.values = {height, width, config.input_channels()};
        grid_.touched = {height, width};
        since_ = {height, width};
        for (float& v : since_.values()) v = 8;
        x_ = width / 2;
        y_ = height / 2;
    }

    enum class Kind { silence, patch, everywhere };
    const VoxelGrid& next(Kind kind) {
        grid_.window = {grid_.window.end, grid_.window.end + SensorDuration{50'000}};
        grid_.events = 0;
        const int height = grid_.values.height(), width = grid_.values.width();
        y_ = std::clamp(y_ + int(random_() % 7) - 3, 0, height - 1);
        x_ = std::clamp(x_ + int(random_() % 7) - 3, 0, width - 1);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const bool near = std::abs(y - y_) < 8 && std::abs(x - x_) < 8;
                const bool active = kind == Kind::everywhere ? random_() % 2 == 0
                                    : kind == Kind::patch    ? near && random_() % 3 == 0
                                                             : false;
                fill(y, x, active);
            }
        return grid_;
    }
    /// Mostly patches, with pauses of several frames and bursts.
    const VoxelGrid& next() {
        if (pause_ > 0) {
            --pause_;
            return next(Kind::silence);
        }
        const auto dice = random_() % 20;
        if (dice == 0) pause_ = 6;
        return next(dice == 1 ? Kind::everywhere : Kind::patch);
    }

private:
    void fill(int y, int x, bool active) {
        const auto pixel = grid_.values.pixel(y, x);
        since_(y, x) = active ? 0 : std::min(since_(y, x) + 1, 8.0F);
        std::ranges::fill(pixel, 0.0F);
        grid_.touched(y, x) = std::uint8_t(active);
        pixel[std::size_t(4 * bins_)] = since_(y, x) / 8;
        if (!active) return;
        const auto b = std::size_t(4) * (random_() % std::size_t(bins_));
        const bool hot = random_() % 500 == 0;
        const float count = hot ? 100'000 : float(1 + random_() % 3);
        pixel[b] = random_() % 2 == 0 ? count : -count;
        pixel[b + 1] = float(random_() % 1000) / 1000;
        pixel[b + 2] = float(random_() % 500) / 1000;
        pixel[b + 3] = count;
        grid_.events += std::uint64_t(count);
    }

    int bins_, x_ = 0, y_ = 0, pause_ = 0;
    std::mt19937 random_;
    VoxelGrid grid_;
    Array2<float> since_;
};

/// A small network that still has every kind of part.
inline ModelConfig small_config() {
    ModelConfig config;
    config.bins = 2;
    config.widths = {8, 12, 20};
    config.recurrent = {1, 0, 1};
    config.res_blocks = 1;
    config.gate_radius = 2;
    config.gate_spread = 1;
    config.blend = Blend::smooth;
    config.latent = 5;
    config.mlp = {24, 16};
    return config;
}
inline ModelConfig thesis_config() {
    ModelConfig config;
    config.encoder = EncoderKind::thesis;
    config.bins = 2;
    config.widths = {24};
    config.recurrent = {1};
    config.res_blocks = 1;
    config.mlp = {128, 128, 128, 128};
    return config;
}

template <typename To, typename From>
Array3<To> as(const Array3<From>& from) {
    Array3<To> to{from.height(), from.width(), from.channels()};
    for (std::size_t i = 0; i < from.values().size(); ++i) to.values()[i] = To(from.values()[i]);
    return to;
}

/// The largest difference, and NaN where either has one.
template <typename A, typename B>
double worst(const A& a, const B& b) {
    double most = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double d = std::abs(double(a[i]) - double(b[i]));
        if (!(d <= most)) most = d;
    }
    return most;
}

}  // namespace eventide::test
