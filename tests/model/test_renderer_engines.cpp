// The implicit decoder: its formula against plain against fast.
#include "apps/cli/stress/double_renderer.h"
#include "src/model/render/plain_renderer.h"
#include "src/model/render/renderer.h"
#include "tests/model/engine_choices.h"
#include "tests/model/latents.h"
#include "tests/model/threads.h"
#include "tests/support/random_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <random>
#include <utility>
#include <vector>

namespace eventide {
namespace {

using test::config_of, test::fading_config, test::random_latent, test::with;

/// Two orders of summing a few hundred float32 products of size 1.
constexpr double kFloatTolerance = 1e-4;
constexpr double kDoubleTolerance = 1e-11;

std::vector<ModelConfig> every_kind() {
    return {config_of(1), config_of(2), fading_config()};
}

FrameGeometry frame_geometry_of(int height, int width, int out_height, int out_width) {
    FrameGeometry geometry;
    geometry.sensor_height = height;
    geometry.sensor_width = width;
    geometry.height = geometry.part_height = out_height;
    geometry.width = geometry.part_width = out_width;
    return geometry;
}

const std::vector<std::pair<int, int>> kOutputs{{1, 1},   {9, 13}, {17, 25}, {18, 26},
                                                {23, 31}, {5, 40}, {9, 1},   {1, 13}};

TEST(Renderer, PlainAgreesWithTheFormulaAtEverySizeTimeAndLookahead) {
    for (const ModelConfig& config : every_kind()) {
        const Model model = test::random_model(config, 3);
        const stress::DoubleRenderer formula{model};
        const plain::MlpRenderer<double> network{model};
        std::vector<Array3<double>> z;
        for (int k = 1; k <= 4; ++k)
            z.push_back(test::as<double>(random_latent(config, 9, 13, k).values));
        const std::vector<plain::Codes<double>> choices{{nullptr, nullptr, &z[0], nullptr, nullptr},
                                                        {nullptr, &z[0], &z[1], nullptr, nullptr},
                                                        {&z[0], &z[1], &z[2], nullptr, nullptr},
                                                        {nullptr, &z[0], &z[1], &z[2], nullptr},
                                                        {nullptr, &z[0], &z[1], &z[2], &z[3]}};
        for (const auto& codes : choices)
            for (const auto& [height, width] : kOutputs)
                for (const double fraction : {0.0, 0.3, 1.0})
                    for (const SigmaRule rule : {SigmaRule::log_blend, SigmaRule::mixture}) {
                        const auto geometry = frame_geometry_of(9, 13, height, width);
                        const auto a = formula.render(codes, fraction, geometry, rule);
                        const auto b = network.render(codes, fraction, geometry, rule);
                        EXPECT_LE(test::worst(a.intensity.values(), b.intensity.values()),
                                  kDoubleTolerance);
                        EXPECT_LE(test::worst(a.sigma.values(), b.sigma.values()),
                                  kDoubleTolerance);
                    }
    }
}

/// Renders everything askable after each push with both, and says the worst difference.
double compare(Renderer a, Renderer b, const ModelConfig& config, int height, int width,
               const std::vector<std::pair<int, int>>& sizes) {
    double most = 0;
    for (int k = 1; k <= 6; ++k) {
        // A still stretch in the middle, where maps are carried over.
        const LatentMap latent = [&] {
            LatentMap map = random_latent(config, height, width, k >= 3 && k <= 5 ? 3 : k);
            map.window = random_latent(config, 1, 1, k).window;
            return map;
        }();
        a.push(latent);
        b.push(latent);
        if (k == 6) {
            a.finish();
            b.finish();
        }
        for (int j = std::max(1, k - 2); j <= k; ++j)
            for (const auto& [out_height, out_width] : sizes)
                for (int lookahead = 0; lookahead <= 2; ++lookahead)
                    for (const double f : {0.25, 1.0}) {
                        const Window w = random_latent(config, 1, 1, j).window;
                        RenderRequest request;
                        request.t =
                            w.begin + SensorDuration{std::int64_t(double(w.width().count()) * f)};
                        request.width = out_width;
                        request.height = out_height;
                        request.lookahead = lookahead;
                        request.sigma_rule =
                            lookahead == 1 ? SigmaRule::mixture : SigmaRule::log_blend;
                        EXPECT_EQ(a.ready(request.t, lookahead), k == 6 || j + lookahead <= k);
                        if (!a.ready(request.t, lookahead)) continue;
                        Frame fa = a.make_output(request), fb = b.make_output(request);
                        a.render(request, fa);
                        b.render(request, fb);
                        most = std::max({most,
                                         test::worst(fa.intensity.values(), fb.intensity.values()),
                                         test::worst(fa.sigma.values(), fb.sigma.values())});
                    }
    }
    return most;
}

TEST(Renderer, FastAgreesWithPlainAtEverySizeTimeAndLookahead) {
    for (const ModelConfig& config : every_kind()) {
        const Model model = test::random_model(config, 3);
        for (const test::EngineChoice& choice : test::engine_choices()) {
            if (choice.bf16) continue;
            EXPECT_LE(compare({model, 13, 9, choice.options}, {model, 13, 9, with(Engine::plain)},
                              config, 9, 13, kOutputs),
                      kFloatTolerance)
                << choice.name;
        }
        EXPECT_LE(compare({model, 1, 1, with(Engine::fast)}, {model, 1, 1, with(Engine::plain)},
                          config, 1, 1, {{1, 1}, {3, 2}}),
                  kFloatTolerance);
    }
}

TEST(Renderer, FramesOfEverySizeShowWhatTheSensorSawWhereItSawIt) {
    constexpr int kHeight = 10, kWidth = 13;
    // Steps between pixels of the frame that are as long as `of` steps of the sensor.
    constexpr std::array<std::pair<int, int>, 3> kSteps{{{1, 3}, {7, 3}, {2, 1}}};
    for (const ModelConfig& config : every_kind()) {
        const Model model = test::random_model(config, 3);
        for (const Engine engine : {Engine::plain, Engine::fast}) {
            Renderer renderer{model, kWidth, kHeight, with(engine)};
            for (int k = 1; k <= 4; ++k) renderer.push(random_latent(config, kHeight, kWidth, k));
            const auto frame_of = [&](int height, int width) {
                RenderRequest request{.t = random_latent(config, 1, 1, 4).window.end,
                                      .width = width,
                                      .height = height};
                Frame frame = renderer.make_output(request);
                renderer.render(request, frame);
                return frame;
            };
            const Frame plain_size = frame_of(kHeight, kWidth);
            for (const auto& [steps, of] : kSteps) {
                const Frame frame =
                    frame_of((kHeight - 1) * steps / of + 1, (kWidth - 1) * steps / of + 1);
                for (int y = 0; y * of < kHeight; ++y)
                    for (int x = 0; x * of < kWidth; ++x) {
                        EXPECT_NEAR(frame.intensity(y * steps, x * steps),
                                    plain_size.intensity(y * of, x * of), kFloatTolerance);
                        EXPECT_NEAR(frame.sigma(y * steps, x * steps),
                                    plain_size.sigma(y * of, x * of), kFloatTolerance);
                    }
            }
        }
    }
}

TEST(Renderer, FastAgreesWithPlainForTheDefaultNetwork) {
    const ModelConfig config;
    const Model model = test::random_model(config, 3);
    EXPECT_LE(compare({model, 70, 40, with(Engine::fast)}, {model, 70, 40, with(Engine::plain)},
                      config, 40, 70, {{40, 70}}),
              kFloatTolerance);
}

TEST(Renderer, Bf16StaysNear) {
    const ModelConfig config;
    const Model model = test::random_model(config, 3);
    EngineOptions emulated;
    emulated.emulate_bf16 = true;
    const double error = compare({model, 70, 40, emulated}, {model, 70, 40, with(Engine::fast)},
                                 config, 40, 70, {{40, 70}});
    EXPECT_LE(error, 0.1);
    std::printf("  worst %.2g\n", error);
}

TEST(Renderer, ThreadsChangeNoBit) {
    for (const ModelConfig& config : {config_of(1), fading_config()}) {
        const Model model = test::random_model(config, 3);
        for (const test::EngineChoice& choice : test::engine_choices()) {
            EngineOptions many = choice.options;
            many.parallel_for = test::with_threads(3);
            EXPECT_EQ(compare({model, 75, 61, many}, {model, 75, 61, choice.options}, config, 61,
                              75, {{61, 75}, {70, 90}}),
                      0)
                << choice.name;
        }
    }
}

void expect_carrying_over_changes_no_bit(const ModelConfig& config) {
    EngineOptions all = with(Engine::fast);
    all.skip_quiet = false;
    const Model model = test::random_model(config, 3);
    Renderer a{model, 75, 61, with(Engine::fast)}, b{model, 75, 61, all};
    LatentMap latent = random_latent(config, 61, 75, 1);
    std::mt19937 random{4};
    for (int k = 1; k <= 12; ++k) {
        latent.window = random_latent(config, 1, 1, k).window;
        if (random() % 3 != 0) latent.values(int(random() % 61), int(random() % 75), 0) += 0.5F;
        a.push(latent);
        b.push(latent);
        // Lookaheads change in between, as a user's may.
        const int lookahead = std::min(k - 1, int(random() % 3));
        RenderRequest request;
        request.t = random_latent(config, 1, 1, k - lookahead).window.end - SensorDuration{9'000};
        request.lookahead = lookahead;
        Frame fa = a.make_output(request), fb = b.make_output(request);
        a.render(request, fa);
        b.render(request, fb);
        ASSERT_EQ(fa.intensity, fb.intensity) << "event window " << k;
        ASSERT_EQ(fa.sigma, fb.sigma);
    }
}

TEST(Renderer, CarryingOverUnchangedTilesChangesNoBit) {
    expect_carrying_over_changes_no_bit(config_of(1));
    expect_carrying_over_changes_no_bit(fading_config());
}

}  // namespace
}  // namespace eventide
