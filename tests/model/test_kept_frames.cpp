// Tiles of frames that are copied from frames before: never another bit where nothing may change,
// within the stated bound elsewhere, and work that follows what changes.
#include "src/model/encode/encoder.h"
#include "src/model/render/renderer.h"
#include "src/nn/tiling.h"
#include "tests/model/streams.h"
#include "tests/support/random_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace eventide {
namespace {

constexpr SensorDuration kWindow{50'000};

ModelConfig fading_config() {
    ModelConfig config = test::small_config();
    config.live_edge = LiveEdge::fade;
    config.unfold = 1;
    return config;
}

EngineOptions without_copies() {
    EngineOptions options;
    options.precision = Precision::f32;
    options.skip_quiet = false;
    return options;
}

EngineOptions with_copies(double still_codes, double still_time) {
    EngineOptions options;
    options.precision = Precision::f32;
    options.still_codes = still_codes;
    options.still_time = still_time;
    return options;
}

/// What is asked for in every window, one after the other.
std::vector<RenderRequest> requests(int lookahead) {
    RenderRequest native, larger, part;
    larger.width = 130;
    larger.height = 91;
    part = larger;
    part.region = {33, 20, 50, 41};
    part.sigma_rule = SigmaRule::mixture;
    std::vector<RenderRequest> all{native, larger, native, part, native};
    all[2].want_sigma = false;
    all[4].sigma_rule = SigmaRule::mixture;
    for (RenderRequest& request : all) request.lookahead = lookahead;
    return all;
}

/// `asked`: what is rendered at each time, in turn.
void expect_same_frames(const ModelConfig& config, int lookahead,
                        const std::vector<RenderRequest>& asked) {
    const Model model = test::random_model(config, 1);
    Encoder encoder{model, 96, 64};
    Renderer copying{model, 96, 64, with_copies(0, 0)}, judge{model, 96, 64, without_copies()};
    test::GridStream stream{config, 64, 96, 5};
    LatentMap latent = encoder.make_output();
    for (int k = 1; k <= 16; ++k) {
        using Kind = test::GridStream::Kind;
        encoder.encode(stream.next(k % 8 > 3 ? Kind::silence : Kind::patch), latent);
        copying.push(latent);
        judge.push(latent);
        for (const int thousandths : {300, 1000})
            for (RenderRequest request : asked) {
                request.t =
                    latent.window.begin - kWindow * lookahead + kWindow * thousandths / 1000;
                if (!judge.ready(request.t, lookahead)) continue;
                Frame a = copying.make_output(request), b = judge.make_output(request);
                copying.render(request, a);
                judge.render(request, b);
                ASSERT_TRUE(std::ranges::equal(a.intensity.values(), b.intensity.values())) << k;
                ASSERT_TRUE(std::ranges::equal(a.sigma.values(), b.sigma.values())) << k;
            }
    }
    // Two geometries stay laid out; turns of more are rendered anew.
    if (asked.size() <= 2) {
        EXPECT_LT(copying.pixels_rendered(), judge.pixels_rendered());
    }
}

TEST(KeptFrames, AreTheSameBitForBit) {
    const auto expect_same = [](const ModelConfig& config, const std::vector<int>& lookaheads) {
        for (const int lookahead : lookaheads) {
            const std::vector<RenderRequest> all = requests(lookahead);
            expect_same_frames(config, lookahead, all);
            for (const std::size_t one : {0, 3}) expect_same_frames(config, lookahead, {all[one]});
            expect_same_frames(config, lookahead, {all[0], all[1]});
            expect_same_frames(config, lookahead, {all[2], all[0], all[4]});
        }
    };
    expect_same(test::small_config(), {0, 1, 2});
    expect_same(fading_config(), {0});
}

/// Renderers of random codes, of which each window changes what it is told to.
class KeptFramesOfCodes : public testing::Test {
protected:
    static constexpr int kWidth = 320, kHeight = 256;

    explicit KeptFramesOfCodes(const ModelConfig& config = test::small_config())
        : model_(test::random_model(config, 1)) {
        latent_.values = {kHeight, kWidth, config.latent};
        for (float& v : latent_.values.values()) v = float(random_() % 2001) / 1000 - 1;
    }
    void push(Renderer& renderer) { renderer.push(latent_); }
    void next_window() { latent_.window = {latent_.window.end, latent_.window.end + kWindow}; }
    Frame render(Renderer& renderer, int thousandths, int width = 0) const {
        RenderRequest request{.width = width};
        request.t = latent_.window.begin + kWindow * thousandths / 1000;
        Frame frame = renderer.make_output(request);
        renderer.render(request, frame);
        return frame;
    }
    void expect_same(Renderer& copying, Renderer& judge, int thousandths, int width = 0) const {
        const Frame a = render(copying, thousandths, width), b = render(judge, thousandths, width);
        EXPECT_TRUE(std::ranges::equal(a.intensity.values(), b.intensity.values()));
    }
    /// The most that outputs can differ where the first layer's inputs differ by `change` at most.
    double most_of(const std::vector<double>& change) const {
        std::vector<double> reach = change;
        for (std::size_t layer = 0; layer <= model_.config.mlp.size(); ++layer) {
            const Tensor& weight =
                model_.weights.at("renderer.mlp." + std::to_string(layer) + ".weight");
            std::vector<double> next(std::size_t(weight.shape[0]));
            for (std::size_t o = 0; o < next.size(); ++o)
                for (std::size_t i = 0; i < reach.size(); ++i)
                    next[o] += std::abs(double(weight.values[o * reach.size() + i])) * reach[i];
            reach = next;
        }
        return reach[0];
    }

    Model model_;
    LatentMap latent_;
    std::mt19937 random_{1};
};

TEST_F(KeptFramesOfCodes, WorkFollowsWhatChanges) {
    Renderer renderer{model_, kWidth, kHeight, with_copies(0, 0)};
    constexpr std::uint64_t kPixels = std::uint64_t{kWidth} * kHeight;
    std::uint64_t before = 0;
    for (int k = 1; k <= 12; ++k) {
        next_window();
        // Within one of the 80 tiles.
        for (int y = 104; y < 120; ++y)
            for (int x = 168; x < 184; ++x) latent_.values.pixel(y, x)[0] += .5F;
        push(renderer);
        render(renderer, 400);
        const std::uint64_t rendered = renderer.pixels_rendered() - before;
        before = renderer.pixels_rendered();
        if (k > 3) {
            EXPECT_EQ(rendered, kPixels / 80) << k;
        }
    }
    next_window();
    push(renderer);
    render(renderer, 400);
    before = renderer.pixels_rendered();
    for (int k = 0; k < 20; ++k) {
        next_window();
        push(renderer);
        render(renderer, 400);
    }
    EXPECT_LE(renderer.pixels_rendered() - before, 2 * kPixels / 80) << "nothing changes any more";
}

/// Many short event windows to a frame, each at a place of its own in its window.
TEST_F(KeptFramesOfCodes, WhatRestsIsCopiedHoweverManyWindowsLieBetweenFrames) {
    Renderer copying{model_, kWidth, kHeight, with_copies(0, 0)};
    Renderer judge{model_, kWidth, kHeight, without_copies()};
    constexpr std::uint64_t kPixels = std::uint64_t{kWidth} * kHeight;
    std::uint64_t before = 0;
    for (int k = 1; k <= 200; ++k) {
        next_window();
        // Within one of the 80 tiles.
        for (int y = 104; y < 120; ++y) latent_.values.pixel(y, 170)[0] += .5F;
        push(copying);
        push(judge);
        if (k % 4 != 0) continue;
        if (k == 168) before = copying.pixels_rendered();
        expect_same(copying, judge, 100 + 4 * k);
    }
    EXPECT_LE(copying.pixels_rendered() - before, 9 * kPixels / 80);
}

TEST_F(KeptFramesOfCodes, CodesThatDriftStayWithinTheBound) {
    constexpr double kBound = .01;
    Renderer copying{model_, kWidth, kHeight, with_copies(kBound, 0)};
    Renderer judge{model_, kWidth, kHeight, without_copies()};
    std::vector<double> change(std::size_t(model_.config.unfolded() + 3), kBound);
    std::ranges::fill(change.end() - 3, change.end(), 0.0);
    const double most = most_of(change);
    for (int k = 1; k <= 20; ++k) {
        next_window();
        for (float& v : latent_.values.values()) v += .004F;  // further than the bound in 3 windows
        push(copying);
        push(judge);
        const Frame a = render(copying, 600), b = render(judge, 600);
        EXPECT_LE(test::worst(a.intensity.values(), b.intensity.values()), most + 1e-5) << k;
    }
    EXPECT_LT(copying.pixels_rendered(), judge.pixels_rendered() * 3 / 4);
}

TEST_F(KeptFramesOfCodes, CodesThatDriftAreTheirOwnWhereNothingIsLeftOut) {
    EngineOptions options = with_copies(.01, 0);
    options.skip_quiet = false;
    Renderer renderer{model_, kWidth, kHeight, options};
    Renderer judge{model_, kWidth, kHeight, without_copies()};
    for (int k = 1; k <= 2; ++k) {
        next_window();
        for (float& v : latent_.values.values()) v += .004F;
        push(renderer);
        push(judge);
        expect_same(renderer, judge, 600);
    }
}

TEST_F(KeptFramesOfCodes, TimeStaysWithinTheBound) {
    constexpr double kBound = .25;
    Renderer copying{model_, kWidth, kHeight, with_copies(0, kBound)};
    Renderer judge{model_, kWidth, kHeight, without_copies()};
    std::vector<double> change(std::size_t(model_.config.unfolded() + 3), 0);
    *(change.end() - 3) = kBound;
    const double most = most_of(change);
    for (int k = 1; k <= 20; ++k) {
        next_window();
        push(copying);
        push(judge);
        const int place = (k * 370) % 1000;
        const Frame a = render(copying, place), b = render(judge, place);
        EXPECT_LE(test::worst(a.intensity.values(), b.intensity.values()), most + 1e-5) << k;
    }
    EXPECT_LT(copying.pixels_rendered(), judge.pixels_rendered() / 2);
}

TEST_F(KeptFramesOfCodes, WhatChangedAfterAFrameOfLongAgoIsSeen) {
    // Changes are kept account of for 16 windows.
    Renderer copying{model_, kWidth, kHeight, with_copies(0, 0)};
    Renderer judge{model_, kWidth, kHeight, without_copies()};
    for (int k = 1; k <= 30; ++k) {
        next_window();
        if (k == 4) latent_.values.pixel(110, 170)[0] += .5F;
        push(copying);
        push(judge);
        if (k == 2 || k == 30) expect_same(copying, judge, 600);
    }
}

TEST_F(KeptFramesOfCodes, WhatChangesAcrossATilesEdgeIsSeen) {
    // The encoder says whose codes are new; samples at the edges of the tiles beside read them.
    const std::vector<Tile> tiles = latent_tiles(kHeight, kWidth);
    const std::size_t middle = tiles.size() / 2 + 5;
    const Tile tile = tiles[middle];
    Renderer copying{model_, kWidth, kHeight, with_copies(0, 0)};
    Renderer judge{model_, kWidth, kHeight, without_copies()};
    latent_.history = {1, 1, std::vector<std::uint64_t>(tiles.size(), 1)};
    for (const auto& [y, x] : {std::pair{tile.y0, tile.x0}, {tile.y1 - 1, tile.x1 - 1}})
        for (int k = 0; k < 5; ++k, ++latent_.history.step) {
            next_window();
            if (k == 4) {
                latent_.values.pixel(y, x)[0] += .5F;
                latent_.history.changed[middle] = latent_.history.step;
            }
            push(copying);
            push(judge);
            expect_same(copying, judge, 1000);
        }
}

TEST_F(KeptFramesOfCodes, AFrameOfAWindowBeforeIsNotThatOfALaterOne) {
    Renderer copying{model_, kWidth, kHeight, with_copies(0, 0)};
    Renderer judge{model_, kWidth, kHeight, without_copies()};
    for (int k = 1; k <= 5; ++k) {
        next_window();
        latent_.values.pixel(110, 170)[0] += .5F;
        push(copying);
        push(judge);
        if (k < 3) continue;
        for (const int thousandths : {600, -400, 600, -1400, -400})
            expect_same(copying, judge, thousandths);
    }
}

TEST_F(KeptFramesOfCodes, AFrameOfAnotherLookaheadReadsOtherCodesThoughNoneChanges) {
    Renderer copying{model_, kWidth, kHeight, with_copies(0, 0)};
    Renderer judge{model_, kWidth, kHeight, without_copies()};
    for (int k = 1; k <= 6; ++k) {
        next_window();
        push(copying);
        push(judge);
    }
    for (const int lookahead : {0, 2, 1, 2, 0}) {
        RenderRequest request{.lookahead = lookahead};
        request.t = latent_.window.end - 2 * kWindow - kWindow / 3;
        Frame a = copying.make_output(request), b = judge.make_output(request);
        copying.render(request, a);
        judge.render(request, b);
        EXPECT_EQ(a.intensity, b.intensity) << lookahead;
    }
}

TEST_F(KeptFramesOfCodes, ResetForgetsThoseOfEachSize) {
    Renderer copying{model_, kWidth, kHeight, with_copies(0, 0)};
    for (int stream = 1; stream <= 3; ++stream) {
        Renderer fresh{model_, kWidth, kHeight, without_copies()};
        latent_.window = {};
        next_window();
        for (float& v : latent_.values.values()) v += .1F;
        push(copying);
        push(fresh);
        for (const int width : {0, 200}) expect_same(copying, fresh, 600, width);
        copying.reset();
    }
}

TEST_F(KeptFramesOfCodes, ResetForgetsThem) {
    Renderer renderer{model_, kWidth, kHeight, with_copies(0, 1)};
    for (int stream = 1; stream <= 2; ++stream) {
        next_window();
        push(renderer);
        render(renderer, 400);
        EXPECT_EQ(renderer.pixels_rendered(), std::uint64_t(stream) * kWidth * kHeight);
        renderer.reset();
    }
}

}  // namespace
}  // namespace eventide
