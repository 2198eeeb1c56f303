// What does not change is shown as it was at any time and size, whoever renders it.
#include "src/model/encode/encoder.h"
#include "src/model/render/renderer.h"
#include "tests/model/latents.h"
#include "tests/model/streams.h"
#include "tests/support/random_model.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

namespace eventide {
namespace {

constexpr int kWidth = 140, kHeight = 60;

struct Way {
    Engine engine = Engine::fast;
    bool emulate_bf16 = false, skip_quiet = true;
    int lookahead = 0, width = 0, height = 0;
};

/// Frames of a scene whose events stop, or go on in its left corner: of two late windows, at
/// several times each.
std::vector<Frame> late_frames(const ModelConfig& config, const Way& way, bool goes_on) {
    const Model model = test::random_model(config, 2);
    EngineOptions options;
    options.engine = way.engine;
    options.precision = Precision::f32;
    options.emulate_bf16 = way.emulate_bf16;
    options.skip_quiet = way.skip_quiet;
    Encoder encoder{model, kWidth, kHeight, options};
    Renderer renderer{model, kWidth, kHeight, options};
    LatentMap latent = encoder.make_output();
    test::GridStream stream{config, kHeight, kWidth, 3};
    std::vector<Window> windows;
    std::vector<Frame> frames;
    RenderRequest request;
    request.lookahead = way.lookahead;
    request.width = way.width;
    request.height = way.height;
    constexpr int kWindows = 12, kStops = 4;
    for (int k = 0; k < kWindows; ++k) {
        VoxelGrid grid = stream.next(k < kStops ? test::GridStream::Kind::everywhere
                                                : test::GridStream::Kind::silence);
        if (k >= kStops && goes_on)
            for (int y = 0; y < 6; ++y) {
                grid.touched(y, y) = 1;
                grid.values(y, y, 3) = float(1 + k % 3);
                grid.values(y, y, grid.values.channels() - 1) = 0;
            }
        windows.push_back(grid.window);
        encoder.encode(grid, latent);
        renderer.push(latent);
        const int shown = k - way.lookahead;
        if (shown < kWindows - 2 - way.lookahead) continue;
        for (const int us : {1, 7'000, 25'000, 41'000, 50'000}) {
            request.t = windows[std::size_t(shown)].begin + SensorDuration{us};
            renderer.render(request, frames.emplace_back(renderer.make_output(request)));
        }
    }
    return frames;
}

/// Columns of pixels that are not the same in all frames.
std::size_t changing_columns(const std::vector<Frame>& frames) {
    std::set<int> columns;
    for (const Frame& frame : frames)
        for (int y = 0; y < frame.intensity.height(); ++y)
            for (int x = 0; x < frame.intensity.width(); ++x)
                if (frame.intensity(y, x) != frames[0].intensity(y, x) ||
                    frame.sigma(y, x) != frames[0].sigma(y, x))
                    columns.insert(x);
    return columns.size();
}

std::vector<Way> ways() {
    std::vector<Way> all;
    for (const int lookahead : {0, 1, 2}) {
        all.push_back({.lookahead = lookahead});
        all.push_back({.skip_quiet = false, .lookahead = lookahead});
        all.push_back({.emulate_bf16 = true, .lookahead = lookahead, .width = 200, .height = 90});
        all.push_back({.engine = Engine::plain, .lookahead = lookahead});
    }
    return all;
}

TEST(StillScene, IsShownAsItWasAtAnyTime) {
    for (const ModelConfig& config : {test::small_config(), test::fading_config()}) {
        for (const Way& way : ways())
            EXPECT_EQ(changing_columns(late_frames(config, way, false)), 0U)
                << "lookahead " << way.lookahead << ", engine " << int(way.engine);
    }
}

TEST(StillScene, IsShownAsItWasBesideWhatMoves) {
    const ModelConfig config = test::small_config();
    for (const Way& way : ways()) {
        const auto frames = late_frames(config, way, true);
        const std::size_t changing = changing_columns(frames);
        EXPECT_GT(changing, 0U) << "something moves";
        EXPECT_LT(changing, std::size_t(frames[0].intensity.width()) * 2 / 3)
            << "lookahead " << way.lookahead << ", engine " << int(way.engine);
    }
}

TEST(StillScene, IsUnknownToTheThesisNetwork) {
    EXPECT_GT(changing_columns(late_frames(test::thesis_config(), {}, false)), 0U);
}

}  // namespace
}  // namespace eventide
