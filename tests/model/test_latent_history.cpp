// What a latent map says of its changes: copies that are renewed in part are whole copies.
#include "src/model/encode/encoder.h"
#include "src/model/render/renderer.h"
#include "src/nn/tiling.h"
#include "tests/model/streams.h"
#include "tests/support/random_model.h"

#include <gtest/gtest.h>

namespace eventide {
namespace {

using test::GridStream;
using Kind = GridStream::Kind;

constexpr int kHeight = 100, kWidth = 131;

Encoder make_encoder(const Model& model) {
    EngineOptions options;
    options.precision = Precision::f32;
    return {model, kWidth, kHeight, options};
}

/// Of the newest event window that the lookahead allows.
void expect_same_frames(Renderer& one, Renderer& other, const VoxelGrid& newest, int lookahead) {
    RenderRequest request;
    request.lookahead = lookahead;
    request.t = newest.window.end - SensorDuration{50'000 * lookahead + 10'000};
    Frame a = one.make_output(request), b = other.make_output(request);
    one.render(request, a);
    other.render(request, b);
    ASSERT_EQ(a.intensity, b.intensity);
    ASSERT_EQ(a.sigma, b.sigma);
}

/// A stream with silence, patches and bursts, step by step into buffers that take turns, as a
/// pipeline's do.
TEST(LatentHistory, BuffersThatTakeTurnsHoldWhatFreshOnesDo) {
    const ModelConfig config = test::small_config();
    const Model model = test::random_model(config, 1);
    Encoder encoder = make_encoder(model), reference = make_encoder(model);
    GridStream stream{config, kHeight, kWidth, 4};
    std::vector<LatentMap> buffers(5, encoder.make_output());
    std::mt19937 random{1};
    for (int i = 0; i < 60; ++i) {
        if (i == 40) {
            encoder.reset();
            reference.reset();
        }
        const VoxelGrid& grid = stream.next();
        LatentMap& buffer = buffers[random() % buffers.size()];
        LatentMap fresh = reference.make_output();
        encoder.encode(grid, buffer);
        reference.encode(grid, fresh);
        ASSERT_EQ(buffer.values, fresh.values) << "step " << i;
    }
}

TEST(LatentHistory, ABufferOfAnotherEncoderIsRenewedWhole) {
    const ModelConfig config = test::small_config();
    Encoder other = make_encoder(test::random_model(config, 1)),
            mine = make_encoder(test::random_model(config, 2));
    GridStream stream{config, kHeight, kWidth, 4};
    LatentMap shared = other.make_output();
    mine.encode(stream.next(Kind::patch), shared);
    const LatentMap before = shared;
    for (int i = 0; i < 4; ++i) {
        other.encode(stream.next(Kind::patch), shared);
        ASSERT_NE(shared.values, before.values);
        mine.encode(stream.next(Kind::silence), shared);
        ASSERT_EQ(shared.values, before.values) << "silence changes no code of mine";
    }
}

TEST(LatentHistory, OnlyWhatIsTouchedChanges) {
    const ModelConfig config = test::small_config();
    Encoder encoder = make_encoder(test::random_model(config, 1));
    GridStream stream{config, kHeight, kWidth, 4};
    LatentMap z = encoder.make_output();
    encoder.encode(stream.next(Kind::everywhere), z);
    encoder.encode(stream.next(Kind::silence), z);
    const LatentHistory still = z.history;
    EXPECT_EQ(std::ranges::count(still.changed, still.step), 0) << "silence changes no tile";
    VoxelGrid grid = stream.next(Kind::silence);
    grid.values(2, 3, 3) = 1;
    grid.touched(2, 3) = 1;
    encoder.encode(grid, z);
    const auto changed = std::ranges::count(z.history.changed, z.history.step);
    EXPECT_GE(changed, 1);
    EXPECT_LT(changed, std::ssize(z.history.changed));
}

/// Of a network as deep as the default: the gate's 12 px, 16 that a pixel of the deepest level
/// has, 64 of the blocks' four layers there, and on the way up 5, 5, 5, 5 and 4 pixels (of 8, 4, 2,
/// 1 and 1 px) of doubling, a layer, and groups of outputs that are rounded together.
TEST(LatentHistory, AChangeReachesNoFurtherThanTheLayersDo) {
    constexpr int kFar = 12 + 16 + 64 + 5 * (8 + 4 + 2 + 1) + 4, kWide = 800, kAt = kWide / 2;
    ModelConfig config = test::small_config();
    config.widths = {8, 8, 8, 8, 8};
    config.recurrent = {1, 0, 0, 0, 0};
    config.res_blocks = 2;
    config.gate_radius = 12;
    config.gate_spread = 0;
    EngineOptions options;
    options.precision = Precision::f32;
    Encoder encoder{test::random_model(config, 1), kWide, 48, options};
    GridStream stream{config, 48, kWide, 4};
    LatentMap z = encoder.make_output();
    encoder.encode(stream.next(Kind::everywhere), z);
    VoxelGrid grid = stream.next(Kind::silence);
    grid.values(24, kAt, 3) = 1;
    grid.touched(24, kAt) = 1;
    encoder.encode(grid, z);
    const std::vector<Tile> tiles = latent_tiles(48, kWide);
    for (std::size_t i = 0; i < tiles.size(); ++i)
        if (z.history.changed[i] == z.history.step) {
            EXPECT_LE(tiles[i].x0, kAt + kFar);
            EXPECT_GT(tiles[i].x1, kAt - kFar);
        }
}

/// The same latent maps with and without their history give the same frames.
TEST(LatentHistory, TheRendererRendersAsWithoutIt) {
    const ModelConfig config = test::small_config();
    const Model model = test::random_model(config, 1);
    Encoder encoder = make_encoder(model);
    EngineOptions options;
    options.precision = Precision::f32;
    Renderer with{model, kWidth, kHeight, options}, without{model, kWidth, kHeight, options};
    GridStream stream{config, kHeight, kWidth, 4};
    LatentMap latent = encoder.make_output();
    for (int k = 1; k <= 50; ++k) {
        if (k == 30) {
            with.reset();
            without.reset();
        }
        const VoxelGrid& grid = stream.next();
        encoder.encode(grid, latent);
        LatentMap bare = latent;
        bare.history = {};
        with.push(latent);
        without.push(bare);
        ASSERT_NO_FATAL_FAILURE(expect_same_frames(with, without, grid, k % 30 > 3 ? k % 3 : 0))
            << "event window " << k;
    }
}

/// Maps whose codes the renderer keeps, and that go back to the encoder with others in their place.
TEST(LatentHistory, AMapThatIsTakenGivesTheFramesOfOneThatIsCopied) {
    for (const int unfold : {1, 3})
        for (const Precision precision : {Precision::f32, Precision::automatic}) {
            ModelConfig config = test::small_config();
            config.unfold = unfold;
            const Model model = test::random_model(config, 1);
            EngineOptions options;
            options.precision = precision;
            Encoder encoder{model, kWidth, kHeight, options},
                reference{model, kWidth, kHeight, options};
            Renderer taking{model, kWidth, kHeight, options},
                copying{model, kWidth, kHeight, options};
            GridStream stream{config, kHeight, kWidth, 4};
            std::vector<LatentMap> buffers(3, encoder.make_output());
            std::mt19937 random{1};
            for (int k = 1; k <= 60; ++k) {
                if (k == 35) {
                    taking.reset();
                    copying.reset();
                }
                const VoxelGrid& grid = stream.next();
                LatentMap& latent = buffers[random() % buffers.size()];
                LatentMap fresh = reference.make_output();
                encoder.encode(grid, latent);
                reference.encode(grid, fresh);
                ASSERT_EQ(latent.values, fresh.values) << "codes left in place are renewed, " << k;
                taking.take(latent);
                copying.push(fresh);
                ASSERT_NO_FATAL_FAILURE(
                    expect_same_frames(taking, copying, grid, k % 35 > 3 ? k % 3 : 0))
                    << "event window " << k;
            }
        }
}

/// Where the grid says which pixels have events, the values are not searched for them.
TEST(LatentHistory, TouchedPixelsAreTakenAtTheirWord) {
    const ModelConfig config = test::small_config();
    const Model model = test::random_model(config, 1);
    Encoder told = make_encoder(model), searching = make_encoder(model);
    GridStream stream{config, kHeight, kWidth, 4};
    LatentMap a = told.make_output(), b = searching.make_output();
    for (int i = 0; i < 20; ++i) {
        VoxelGrid grid = stream.next();
        if (i % 2 == 0)  // as many ON as OFF: their sum is 0, and still something happened
            for (int y = 0; y < kHeight; ++y)
                for (int x = 0; x < kWidth; ++x)
                    for (int bin = 0; bin < config.bins; ++bin) grid.values(y, x, 4 * bin) = 0;
        told.encode(grid, a);
        grid.touched = {};
        searching.encode(grid, b);
        ASSERT_EQ(a.values, b.values) << "step " << i;
    }
}

}  // namespace
}  // namespace eventide
