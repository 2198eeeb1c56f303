// A renderer whose frames the camera's images correct: which images count, and what is rendered.
#include "src/model/encode/encoder.h"
#include "src/model/render/fused_renderer.h"
#include "tests/model/fusion_images.h"
#include "tests/model/streams.h"
#include "tests/support/random_model.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace eventide {
namespace {

using namespace test;
using Kind = GridStream::Kind;

/// The whole chain, for each lookahead: an image in silence is what frames show from then on.
TEST(FusedRenderer, ShowsTheImageOfAStillScene) {
    const ModelConfig config = test::small_config();
    const Model model = test::random_model(config, 1);
    for (const int lookahead : {0, 1, 2}) {
        Encoder encoder{model, kWidth, kHeight};
        Renderer renderer{model, kWidth, kHeight};
        FusedRenderer fused{renderer, kWidth, kHeight, lookahead};
        GridStream stream{config, kHeight, kWidth, 4};
        LatentMap latent = encoder.make_output();
        RenderRequest request{.lookahead = lookahead};
        fused.prepare(request);
        Frame frame = renderer.make_output(request);
        for (int i = 0; i < 12; ++i) {
            const VoxelGrid& grid = stream.next(i < 5 ? Kind::patch : Kind::silence);
            encoder.encode(grid, latent);
            latent.window = grid.window;
            if (i == 8) fused.give(image_of(ramp(), grid.window.end));
            if (i == 9) request.t = grid.window.end;
            renderer.push(latent);
            fused.push(grid.window, constant(i < 5 ? 1.F : 0.F));
        }
        fused.render(request, frame);
        EXPECT_EQ(fused.used(), 1U);
        EXPECT_EQ(fused.dropped(), 0U);
        for (std::size_t i = 0; i < frame.intensity.values().size(); ++i)
            ASSERT_NEAR(frame.intensity.values()[i], ramp().values()[i], 1e-3) << lookahead;
    }
}

/// What the flow was found with at a window's end is what a frame shows there.
TEST(FusedRenderer, AFrameAtAWindowsEndIsNotRenderedTwice) {
    const ModelConfig config = test::small_config();
    const Model model = test::random_model(config, 1);
    Encoder encoder{model, kWidth, kHeight};
    Renderer renderer{model, kWidth, kHeight};
    FusedRenderer fused{renderer, kWidth, kHeight, 0};
    GridStream stream{config, kHeight, kWidth, 4};
    LatentMap latent = encoder.make_output();
    RenderRequest request, twice{.width = 2 * kWidth, .height = 2 * kHeight};
    fused.prepare(request);
    Frame frame = renderer.make_output(request), larger = renderer.make_output(twice);
    std::uint64_t at_ends = 0, at_times_within = 0, larger_at_ends = 0;
    for (int i = 0; i < 12; ++i) {
        const VoxelGrid& grid = stream.next(Kind::everywhere);
        encoder.encode(grid, latent);
        latent.window = grid.window;
        fused.give(image_of(ramp(), grid.window.begin + SensorDuration{1}));
        renderer.push(latent);
        fused.push(grid.window, constant(1));
        const auto cost_of = [&](RenderRequest wanted, SensorTime t, Frame& out) {
            const std::uint64_t before = renderer.pixels_rendered();
            wanted.t = t;
            fused.prepare(wanted);
            fused.render(wanted, out);
            return renderer.pixels_rendered() - before;
        };
        at_ends += cost_of(request, grid.window.end, frame);
        larger_at_ends += cost_of(twice, grid.window.end, larger);
        at_times_within += cost_of(request, grid.window.end - SensorDuration{7}, frame);
    }
    constexpr std::uint64_t kPixels = std::uint64_t{kWidth} * kHeight;
    EXPECT_EQ(at_ends, 0U);
    EXPECT_EQ(at_times_within, 12 * kPixels);
    EXPECT_EQ(larger_at_ends, 12 * 4 * kPixels);
}

/// Of a still scene and images of one grey each, given before the fifth window of 50 ms.
struct GivenInSilence {
    float shown = 0;
    std::uint64_t used = 0, dropped = 0;
};

GivenInSilence given_in_silence(const std::vector<std::pair<float, double>>& greys_and_ms) {
    const ModelConfig config = test::small_config();
    const Model model = test::random_model(config, 1);
    Encoder encoder{model, kWidth, kHeight};
    Renderer renderer{model, kWidth, kHeight};
    FusedRenderer fused{renderer, kWidth, kHeight, 0};
    GridStream stream{config, kHeight, kWidth, 4};
    LatentMap latent = encoder.make_output();
    RenderRequest request;
    fused.prepare(request);
    Frame frame = renderer.make_output(request);
    for (int i = 0; i < 8; ++i) {
        const VoxelGrid& grid = stream.next(i < 3 ? Kind::patch : Kind::silence);
        encoder.encode(grid, latent);
        request.t = latent.window.end = grid.window.end;
        if (i == 4)
            for (const auto& [grey, ms] : greys_and_ms)
                fused.give(image_of(constant(grey), grid.window.end + (at_ms(ms) - at_ms(0))));
        renderer.push(latent);
        fused.push(grid.window, constant(i < 3 ? 1.F : 0.F));
    }
    fused.render(request, frame);
    return {frame.intensity(kHeight / 2, kWidth / 2), fused.used(), fused.dropped()};
}

TEST(FusedRenderer, AnImageOfAWrongTimeDoesNotHoldUpTheOthers) {
    constexpr double kAnHour = 3'600'000;
    const GivenInSilence given = given_in_silence({{.9F, kAnHour}, {.3F, -.001}, {.6F, 0}});
    EXPECT_NEAR(given.shown, .6, 1e-3);
    EXPECT_EQ(given.used, 2U);
    EXPECT_EQ(given.dropped, 1U);
}

TEST(FusedRenderer, AnImageThatIsOlderThanTheOneBeforeIsDropped) {
    const GivenInSilence given = given_in_silence({{.6F, 0}, {.3F, -.001}});
    EXPECT_NEAR(given.shown, .6, 1e-3);
    EXPECT_EQ(given.used, 1U);
    EXPECT_EQ(given.dropped, 1U);
}

TEST(FusedRenderer, AFloodOfImagesIsBounded) {
    const Model model = test::random_model(test::small_config(), 1);
    Renderer renderer{model, kWidth, kHeight};
    FusedRenderer fused{renderer, kWidth, kHeight, 0};
    for (int i = 0; i < 1000; ++i) fused.give(image_of(ramp(), at_ms(i)));
    EXPECT_EQ(fused.dropped(), 1000 - FusedRenderer::kMaxWaiting);
}

}  // namespace
}  // namespace eventide
