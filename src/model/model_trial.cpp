// A patch of activity, silence, and a burst.
#include "src/model/model_trial.h"

#include "src/core/error.h"
#include "src/core/sensor_limits.h"
#include "src/model/encode/encoder.h"
#include "src/model/render/renderer.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace eventide {
namespace {

constexpr int kSide = 24;  // px: more than one tile of the latent map in strided networks
constexpr int kWindows = 6;
constexpr SensorDuration kWidth{50'000};
constexpr float kLargest = 1e6F;  // of codes, and of what is 0 for black and 1 for white

/// Window `k`: the pixels of a patch that moves have events; in window 3 none, in the last all.
VoxelGrid made_up_grid(const ModelConfig& config, int k) {
    VoxelGrid grid;
    grid.values = {kSide, kSide, config.input_channels()};
    grid.window = {SensorTime{k * kWidth}, SensorTime{(k + 1) * kWidth}};
    const auto bins = std::size_t(config.bins);
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
            const auto pixel = grid.values.pixel(y, x);
            const bool in_patch = std::abs(x - 4 * k) < 5 && std::abs(y - kSide / 2) < 6;
            const bool active = k == kWindows - 1 || (in_patch && k != 3);
            pixel[4 * bins] = active ? 0.0F : 1.0F;  // age
            if (!active) continue;
            const std::size_t bin = 4 * (std::size_t(x + y + k) % bins);
            pixel[bin] = (x + y) % 2 == 0 ? 2.0F : -2.0F;  // polarities, mean, deviation, number
            pixel[bin + 1] = 0.4F;
            pixel[bin + 2] = 0.1F;
            pixel[bin + 3] = 2.0F;
            grid.events += 2;
        }
    return grid;
}

/// Also what overflowed on the way and was made finite again by a ReLU is seen by its size.
bool is_sound(std::span<const float> values) {
    return std::ranges::all_of(values, [](float v) { return std::abs(v) <= kLargest; });
}

/// At the live edge, and with the codes of later windows: weights of their own read these.
bool shows_sound_frames(Renderer& renderer, SensorTime newest_end) {
    for (int lookahead = 0; lookahead <= kMaxLookahead; ++lookahead) {
        const RenderRequest request{.t = newest_end - lookahead * kWidth - kWidth / 2,
                                    .lookahead = lookahead};
        if (!renderer.ready(request.t, lookahead)) continue;
        Frame frame = renderer.make_output(request);
        renderer.render(request, frame);
        if (!is_sound(frame.intensity.values()) || !is_sound(frame.sigma.values())) return false;
    }
    return true;
}

}  // namespace

void try_model(const Model& model, const std::string& file) {
    EngineOptions options;
    options.precision = Precision::f32;
    options.kernels = Kernels::own;
    Encoder encoder{model, kSide, kSide, options};
    Renderer renderer{model, kSide, kSide, options};
    LatentMap latent = encoder.make_output();
    for (int k = 0; k < kWindows; ++k) {
        const VoxelGrid grid = made_up_grid(model.config, k);
        encoder.encode(grid, latent);
        renderer.push(latent);
        if (is_sound(latent.values.values()) && shows_sound_frames(renderer, grid.window.end))
            continue;
        throw Error(ErrorKind::input,
                    file +
                        ": expected a network that gives frames of about 0 to 1, found NaN, "
                        "infinity or more than a million in made-up event window " +
                        std::to_string(k) + ": its weights are damaged or too large");
    }
}

}  // namespace eventide
