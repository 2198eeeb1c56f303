// Codes as encoders hand them over: bf16 where their products are, and any renderer reads them.
#include "src/model/encode/encoder.h"
#include "src/model/latent_codes.h"
#include "src/model/render/renderer.h"
#include "tests/model/engine_choices.h"
#include "tests/model/streams.h"
#include "tests/support/random_model.h"

#include <gtest/gtest.h>

namespace eventide {
namespace {

constexpr int kHeight = 70, kWidth = 83;

LatentMap in_float(const LatentMap& latent, int depth) {
    LatentMap wide = latent;
    wide.values = codes_in_float(latent, depth);
    wide.is_bf16 = false;
    return wide;
}

Frame frame_of(Renderer& renderer, const LatentMap& latent) {
    RenderRequest request;
    request.t = latent.window.end - SensorDuration{10'000};
    Frame frame = renderer.make_output(request);
    renderer.push(latent);
    renderer.render(request, frame);
    return frame;
}

/// An odd number of channels has a unit of which half is empty.
ModelConfig config_of(int depth) {
    ModelConfig config = test::small_config();
    config.latent = depth;
    return config;
}

TEST(LatentCodes, AreBf16WhereProductsAre) {
    for (const int depth : {7, 8})
        for (const test::EngineChoice& choice : test::engine_choices()) {
            SCOPED_TRACE(choice.name + ", depth " + std::to_string(depth));
            const Model model = test::random_model(config_of(depth), 1);
            const LatentMap latent = Encoder{model, kWidth, kHeight, choice.options}.make_output();
            EXPECT_EQ(latent.is_bf16, choice.bf16);
            EXPECT_EQ(latent.values.channels(), choice.bf16 ? 4 : depth);
            EXPECT_EQ(codes_in_float(latent, depth).channels(), depth);
        }
}

/// bf16 is exact in float32: the same codes, the same frames, whichever numbers the renderer uses.
/// With `still_codes`, parts of codes are taken from the window before.
TEST(LatentCodes, EveryRendererReadsEither) {
    for (const double still_codes : {0.0, 0.05})
        for (const int depth : {7, 8})
            for (const test::EngineChoice& choice : test::engine_choices()) {
                SCOPED_TRACE(choice.name + ", depth " + std::to_string(depth));
                const ModelConfig config = config_of(depth);
                const Model model = test::random_model(config, 1);
                EngineOptions bf16;
                bf16.emulate_bf16 = true;
                Encoder encoder{model, kWidth, kHeight, bf16};
                EngineOptions options = choice.options;
                options.still_codes = still_codes;
                Renderer given{model, kWidth, kHeight, options};
                Renderer widened{model, kWidth, kHeight, options};
                test::GridStream stream{config, kHeight, kWidth, 4};
                LatentMap latent = encoder.make_output();
                ASSERT_TRUE(latent.is_bf16);
                for (int k = 1; k <= 8; ++k) {
                    encoder.encode(stream.next(), latent);
                    const Frame a = frame_of(given, latent),
                                b = frame_of(widened, in_float(latent, depth));
                    ASSERT_EQ(a.intensity, b.intensity) << "event window " << k;
                    ASSERT_EQ(a.sigma, b.sigma) << "event window " << k;
                }
            }
}

TEST(LatentCodes, OfAPlainRendererToo) {
    const ModelConfig config = config_of(7);
    const Model model = test::random_model(config, 1);
    EngineOptions bf16;
    bf16.emulate_bf16 = true;
    Encoder encoder{model, kWidth, kHeight, bf16};
    Renderer given{model, kWidth, kHeight, {.engine = Engine::plain}};
    Renderer widened{model, kWidth, kHeight, {.engine = Engine::plain}};
    test::GridStream stream{config, kHeight, kWidth, 4};
    LatentMap latent = encoder.make_output();
    for (int k = 1; k <= 3; ++k) {
        encoder.encode(stream.next(), latent);
        EXPECT_EQ(frame_of(given, latent).intensity,
                  frame_of(widened, in_float(latent, config.latent)).intensity);
    }
}

}  // namespace
}  // namespace eventide
