// The implicit decoder: its formula against plain against fast, and its geometry.
#include "apps/cli/stress/double_renderer.h"
#include "src/core/error.h"
#include "src/model/render/plain_renderer.h"
#include "src/model/render/renderer.h"
#include "tests/model/engine_choices.h"
#include "tests/model/streams.h"
#include "tests/model/threads.h"
#include "tests/support/random_model.h"

#include <gtest/gtest.h>

namespace eventide {
namespace {

/// Two orders of summing a few hundred float32 products of size 1.
constexpr double kFloatTolerance = 1e-4;
constexpr double kDoubleTolerance = 1e-11;

ModelConfig config_of(int stride) {
    ModelConfig config = test::small_config();
    config.latent_stride = stride;
    return config;
}

/// A renderer that reads codes in time alone, and whose live edge fades.
ModelConfig fading_config() {
    ModelConfig config = test::small_config();
    config.unfold = 1;
    config.live_edge = LiveEdge::fade;
    return config;
}

std::vector<ModelConfig> every_kind() {
    return {config_of(1), config_of(2), fading_config()};
}

LatentMap random_latent(const ModelConfig& config, int height, int width, int k,
                        std::uint32_t seed = 1) {
    const int s = config.latent_stride;
    LatentMap latent;
    latent.values = {(height + s - 1) / s, (width + s - 1) / s, config.latent};
    std::mt19937 random{seed * 100 + std::uint32_t(k)};
    for (float& v : latent.values.values()) v = float(random() % 2001) / 1000 - 1;
    // Windows of unequal width: 50, 60, 70 ms ...
    const auto edge = [](int n) { return from_us(1'000'000 + 50'000 * n + 5'000 * n * n); };
    latent.window = {edge(k - 1), edge(k)};
    latent.events = std::uint64_t(k);
    return latent;
}

EngineOptions with(Engine engine, Precision precision = Precision::f32) {
    EngineOptions options;
    options.engine = engine;
    options.precision = precision;
    return options;
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

TEST(Renderer, TheFirstAndLastOutputPixelsLieOnTheFirstAndLastSensorPixels) {
    for (const int out : {2, 7, 240, 601}) {
        EXPECT_EQ(sample_axis(0, out, 240, 1, Blend::smooth).index, 0);
        EXPECT_EQ(sample_axis(0, out, 240, 1, Blend::smooth).weight[1], 0);
        EXPECT_EQ(sample_axis(out - 1, out, 240, 1, Blend::smooth).index, 239);
        EXPECT_EQ(sample_axis(out - 1, out, 240, 1, Blend::smooth).weight[1], 0);
    }
    for (int i = 0; i < 240; ++i) {
        EXPECT_EQ(sample_axis(i, 240, 240, 1, Blend::smooth).index, i);
        EXPECT_EQ(sample_axis(i, 240, 240, 1, Blend::smooth).weight[0], 1);
    }
    // Stride 2 and an even width: the last pixel lies half a sample past the last sample.
    const AxisSamples last = sample_axis(239, 240, 240, 2, Blend::smooth);
    EXPECT_EQ(last.index, 119);
    EXPECT_EQ(last.weight[0], 1);
    EXPECT_EQ(last.offset[0], 0.5);
}

TEST(Renderer, WeightsInSpaceAreThoseOfTheModelsBlend) {
    for (int i = 0; i < 9; ++i) {  // 8 steps between two samples
        const double f = i / 8.0;
        const AxisSamples linear = sample_axis(i, 9, 2, 1, Blend::linear);
        const AxisSamples smooth = sample_axis(i, 9, 2, 1, Blend::smooth);
        EXPECT_EQ(linear.offset, smooth.offset);
        if (i == 8) continue;  // on the last sample
        EXPECT_DOUBLE_EQ(linear.weight[1], f);
        EXPECT_DOUBLE_EQ(smooth.weight[1], f * f * (3 - 2 * f));
        EXPECT_DOUBLE_EQ(smooth.weight[0] + smooth.weight[1], 1);
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

TEST(Renderer, ImpossibleRequestsAreRefused) {
    const Renderer renderer{test::random_model(config_of(1), 3), 13, 9};
    RenderRequest request;
    request.lookahead = 3;
    EXPECT_THROW(renderer.make_output(request), Error);
    request = {};
    request.width = -4;
    EXPECT_THROW(renderer.make_output(request), Error);
    request = {};
    request.region = {5, 5, 9, 2};
    EXPECT_THROW(renderer.make_output(request), Error);
}

}  // namespace
}  // namespace eventide
