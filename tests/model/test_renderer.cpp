// The implicit decoder: which times and parts it renders, and from which codes.
#include "src/core/error.h"
#include "src/model/render/renderer.h"
#include "tests/model/latents.h"
#include "tests/support/random_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <climits>
#include <optional>
#include <string>
#include <utility>

namespace eventide {
namespace {

using test::config_of, test::fading_config, test::random_latent, test::with;

/// The largest change of intensity over the first microsecond of an event window, and over all of
/// it.
std::pair<double, double> changes_at_the_live_edge(const ModelConfig& config) {
    Renderer renderer{test::random_model(config, 3), 13, 9};
    for (int k = 1; k <= 3; ++k) renderer.push(random_latent(config, 9, 13, k));
    const auto shown = [&](SensorTime t) {
        RenderRequest request;
        request.t = t;
        Frame frame = renderer.make_output(request);
        renderer.render(request, frame);
        return frame.intensity;
    };
    renderer.push(random_latent(config, 9, 13, 4));
    const Window window = random_latent(config, 1, 1, 4).window;
    const auto before = shown(window.begin);
    return {test::worst(before.values(), shown(window.begin + SensorDuration{1}).values()),
            test::worst(before.values(), shown(window.end).values())};
}

TEST(Renderer, ALiveEdgeThatFadesBeginsWithWhatWasShownLast) {
    ModelConfig config = fading_config();
    const auto [step, whole] = changes_at_the_live_edge(config);
    EXPECT_LT(step, 1e-4 * whole);
    config.live_edge = LiveEdge::jump;
    EXPECT_GT(changes_at_the_live_edge(config).first, 0.1 * whole) << "the test sees a jump";
}

TEST(Renderer, AfterAResetFramesAreThoseOfAFreshOne) {
    const ModelConfig config = config_of(1);
    const Model model = test::random_model(config, 3);
    for (const Engine engine : {Engine::fast, Engine::plain}) {
        Renderer used{model, 13, 9, with(engine)}, fresh{model, 13, 9, with(engine)};
        const auto frame_of = [&](Renderer& renderer, int windows, int codes) {
            for (int k = 1; k <= windows; ++k) {
                LatentMap latent = random_latent(config, 9, 13, codes + k);
                latent.window = random_latent(config, 1, 1, k).window;
                renderer.push(latent);
            }
            const RenderRequest request{.t = random_latent(config, 1, 1, windows).window.end};
            Frame frame = renderer.make_output(request);
            renderer.render(request, frame);
            return frame.intensity;
        };
        for (const int windows : {1, 2, 3}) frame_of(used, windows, 10), used.reset();
        EXPECT_EQ(frame_of(used, 3, 20), frame_of(fresh, 3, 20));
    }
}

TEST(Renderer, ARegionIsAPartOfTheWhole) {
    const ModelConfig config = config_of(1);
    for (const Engine engine : {Engine::fast, Engine::plain}) {
        Renderer renderer{test::random_model(config, 3), 30, 20, with(engine)};
        for (int k = 1; k <= 3; ++k) renderer.push(random_latent(config, 20, 30, k));
        RenderRequest whole;
        whole.t = random_latent(config, 1, 1, 2).window.end - SensorDuration{1000};
        whole.width = 75;
        whole.height = 50;
        whole.lookahead = 1;
        RenderRequest part = whole;
        part.region = {11, 7, 40, 0};
        Frame a = renderer.make_output(whole), b = renderer.make_output(part);
        renderer.render(whole, a);
        renderer.render(part, b);
        ASSERT_EQ(b.intensity.height(), 43);
        for (int y = 0; y < 43; ++y)
            for (int x = 0; x < 40; ++x) {
                EXPECT_EQ(b.intensity(y, x), a.intensity(y + 7, x + 11));
                EXPECT_EQ(b.sigma(y, x), a.sigma(y + 7, x + 11));
            }
    }
}

TEST(Renderer, FutureCodesAreNotReadEvenWhereTheyAreThere) {
    const ModelConfig config = config_of(1);
    Renderer early{test::random_model(config, 3), 13, 9},
        late{test::random_model(config, 3), 13, 9};
    early.push(random_latent(config, 9, 13, 1));
    late.push(random_latent(config, 9, 13, 1));
    late.push(random_latent(config, 9, 13, 2));
    RenderRequest request;
    request.t = random_latent(config, 1, 1, 1).window.end;
    Frame a = early.make_output(request), b = late.make_output(request);
    early.render(request, a);
    late.render(request, b);
    EXPECT_EQ(a.intensity, b.intensity);
    EXPECT_EQ(a.sigma, b.sigma);
}

TEST(Renderer, CodesOfAsManyLaterWindowsAreReadAsTheLookaheadSays) {
    const ModelConfig config = config_of(1);
    const Model model = test::random_model(config, 3);
    const auto shown = [&](int lookahead, int replaced) {
        Renderer renderer{model, 13, 9};
        for (int k = 1; k <= 4; ++k) {
            LatentMap latent = random_latent(config, 9, 13, k);
            if (k == replaced) latent.values = random_latent(config, 9, 13, 10).values;
            renderer.push(latent);
        }
        const Window window = random_latent(config, 1, 1, 1).window;
        const RenderRequest request{.t = window.begin + window.width() / 2, .lookahead = lookahead};
        Frame frame = renderer.make_output(request);
        renderer.render(request, frame);
        EXPECT_EQ(frame.window, window);
        EXPECT_EQ(frame.t, request.t);
        EXPECT_EQ(frame.events, 1U);
        return frame.intensity;
    };
    for (int lookahead = 0; lookahead <= 2; ++lookahead)
        for (int k = 1; k <= 4; ++k)
            EXPECT_EQ(shown(lookahead, k) != shown(lookahead, 0), k <= 1 + lookahead)
                << "lookahead " << lookahead << ", event window " << k;
}

TEST(Renderer, SaysWhatItCanRender) {
    const ModelConfig config = config_of(1);
    Renderer renderer{test::random_model(config, 3), 13, 9};
    const auto end_of = [&](int k) { return random_latent(config, 1, 1, k).window.end; };
    EXPECT_EQ(renderer.readiness(end_of(1), 0), Readiness::later);
    for (int k = 1; k <= 6; ++k) renderer.push(random_latent(config, 9, 13, k));
    EXPECT_EQ(renderer.readiness(end_of(6), 0), Readiness::ready);
    EXPECT_EQ(renderer.readiness(end_of(6), 1), Readiness::later);
    EXPECT_EQ(renderer.readiness(end_of(4), 2), Readiness::ready);
    EXPECT_EQ(renderer.readiness(end_of(3), 2), Readiness::gone) << "z_2 is no longer kept";
    EXPECT_EQ(renderer.readiness(end_of(6) + SensorDuration{1}, 0), Readiness::later);
    renderer.finish();
    EXPECT_EQ(renderer.readiness(end_of(6), 2), Readiness::ready) << "the live edge";
    EXPECT_EQ(renderer.readiness(end_of(6) + SensorDuration{1}, 0), Readiness::gone);
    renderer.reset();
    EXPECT_EQ(renderer.readiness(end_of(6), 0), Readiness::later);
}

TEST(Renderer, OfTimesThatAreNotReadyShowsTheNearestWindow) {
    const ModelConfig config = config_of(1);
    for (const int newest : {1, 2, 4, 5, 6, 9}) {
        Renderer renderer{test::random_model(config, 3), 13, 9};
        for (int k = 1; k <= newest; ++k) renderer.push(random_latent(config, 9, 13, k));
        const auto at = [&](SensorTime t) {
            const RenderRequest request{.t = t};
            Frame frame = renderer.make_output(request);
            renderer.render(request, frame);
            return frame;
        };
        const Frame early = at(from_us(0)),
                    late = at(random_latent(config, 1, 1, newest).window.end + SensorDuration{9});
        EXPECT_EQ(early.events, newest <= 5 ? 1U : std::uint64_t(newest - 2));
        EXPECT_EQ(late.events, std::uint64_t(newest));
        EXPECT_EQ(early.intensity, at(renderer.oldest()).intensity);
        EXPECT_EQ(late.intensity, at(late.window.end).intensity);
    }
}

TEST(Renderer, AFrameArrivedWithTheNewestWindowItMayRead) {
    const ModelConfig config = config_of(1);
    Renderer renderer{test::random_model(config, 3), 13, 9};
    const auto at = [](int k) { return HostTime{std::chrono::milliseconds{k}}; };
    for (int k = 1; k <= 4; ++k) {
        LatentMap latent = random_latent(config, 9, 13, k);
        latent.arrived = at(k);
        renderer.push(latent);
    }
    renderer.finish();
    const auto arrived = [&](int k, int lookahead) {
        const RenderRequest request{.t = random_latent(config, 1, 1, k).window.end,
                                    .lookahead = lookahead};
        Frame frame = renderer.make_output(request);
        renderer.render(request, frame);
        return frame.arrived;
    };
    EXPECT_EQ(arrived(3, 0), at(3));
    EXPECT_EQ(arrived(3, 1), at(4));
    EXPECT_EQ(arrived(4, 2), at(4)) << "the live edge";
}

TEST(Renderer, ARequestsRuleForSigmaIsTakenInPlaceOfTheModels) {
    const auto sigma = [](SigmaRule of_model, std::optional<SigmaRule> asked) {
        ModelConfig config = config_of(1);
        config.sigma_rule = of_model;
        Renderer renderer{test::random_model(config, 3), 13, 9};
        renderer.push(random_latent(config, 9, 13, 1));
        const RenderRequest request{
            .t = random_latent(config, 1, 1, 1).window.end, .width = 40, .sigma_rule = asked};
        Frame frame = renderer.make_output(request);
        renderer.render(request, frame);
        return frame.sigma;
    };
    const auto mixture = SigmaRule::mixture, log_blend = SigmaRule::log_blend;
    EXPECT_EQ(sigma(log_blend, mixture), sigma(mixture, {}));
    EXPECT_EQ(sigma(mixture, log_blend), sigma(log_blend, {}));
    EXPECT_NE(sigma(mixture, {}), sigma(log_blend, {}));
}

TEST(Renderer, SigmaOfAMixtureIsANumberWhereItsMembersAreAlike) {
    // Members that say the same, and are sure of it: what rounding leaves of the variance is as
    // often below 0 as above.
    ModelConfig config = config_of(1);
    config.log_sigma_min = -40;
    Model model = test::random_model(config, 3);
    std::ranges::fill(model.weights.at("renderer.mlp.0.weight").values, 0.0F);
    const std::string last = "renderer.mlp." + std::to_string(config.mlp.size());
    model.weights.at(last + ".bias").values[1] = -1000;
    for (const Engine engine : {Engine::plain, Engine::fast}) {
        EngineOptions options;
        options.engine = engine;
        Renderer renderer{model, 13, 9, options};
        for (int k = 1; k <= 3; ++k) renderer.push(random_latent(config, 9, 13, k));
        const Window window = random_latent(config, 1, 1, 2).window;
        const RenderRequest request{.t = window.begin + window.width() / 3,
                                    .width = 40,
                                    .height = 31,
                                    .lookahead = 1,
                                    .sigma_rule = SigmaRule::mixture};
        Frame frame = renderer.make_output(request);
        renderer.render(request, frame);
        for (const float sigma : frame.sigma.values()) {
            ASSERT_GE(sigma, 0);
            ASSERT_LT(sigma, 1e-2F);
        }
    }
}

TEST(Renderer, ImpossibleRequestsAreRefused) {
    Renderer renderer{test::random_model(config_of(1), 3), 13, 9};
    RenderRequest request;
    request.lookahead = 3;
    EXPECT_THROW(renderer.make_output(request), Error);
    request = {};
    request.width = -4;
    EXPECT_THROW(renderer.make_output(request), Error);
    request = {};
    request.lookahead = -1;
    EXPECT_THROW(renderer.make_output(request), Error);
    for (const Region& region :
         {Region{5, 5, 9, 2}, Region{5, 5, 2, 5}, Region{-1, 0, 4, 4}, Region{0, -1, 4, 4},
          Region{0, 0, -4, 4}, Region{0, 0, 4, -4}, Region{13, 0, 0, 0}, Region{0, 9, 0, 0},
          Region{INT_MIN, 0, 0, 0}, Region{0, INT_MIN, 0, 0}, Region{0, 0, INT_MAX, 4}}) {
        request = {};
        request.region = region;
        EXPECT_THROW(renderer.make_output(request), Error)
            << region.width << "x" << region.height << " from " << region.x << "," << region.y;
    }
}

}  // namespace
}  // namespace eventide
