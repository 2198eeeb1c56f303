// What is done to trained weights: their mean, and more contrast.
#include "apps/train/contrast.h"
#include "apps/train/mean_of_models.h"
#include "src/core/error.h"
#include "src/model/encode/encoder.h"
#include "src/model/render/renderer.h"
#include "tests/model/streams.h"
#include "tests/support/random_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

namespace eventide {
namespace {

ModelConfig tiny() {
    ModelConfig config;
    config.widths = {8, 8};
    config.recurrent = {1, 0};
    return config;
}

TEST(MeanOfModels, LiesBetweenThem) {
    Model one = test::random_model(tiny(), 1), other = test::random_model(tiny(), 2);
    one.config.sigma_scale = 1;
    other.config.sigma_scale = 2;
    const Model mean = mean_of({{one, .75}, {other, .25}});
    EXPECT_FLOAT_EQ(mean.config.sigma_scale, 1.25F);
    for (const auto& [name, tensor] : mean.weights)
        for (std::size_t i = 0; i < tensor.values.size(); ++i)
            ASSERT_NEAR(
                tensor.values[i],
                .75 * one.weights.at(name).values[i] + .25 * other.weights.at(name).values[i], 1e-6)
                << name;
    EXPECT_EQ(mean_of({{one, .5}, {one, .5}}).weights, one.weights) << "bit for bit";
}

TEST(MeanOfModels, RefusesOtherOptionsByName) {
    const auto refused = [](const auto& change) -> std::string {
        ModelConfig other = tiny();
        change(other);
        const Model one = test::random_model(tiny(), 1), changed = test::random_model(other, 1);
        try {
            mean_of({{one, .5}, {changed, .5}});
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::input);
            return error.what();
        }
        return "not refused";
    };
    EXPECT_EQ(refused([](ModelConfig& c) { c.noise_filter = true; }),
              "model 2: 'noise_filter': expected off as of the first, found auto");
    using testing::HasSubstr;
    EXPECT_THAT(refused([](ModelConfig& c) { c.bins = 6; }), HasSubstr("'bins'"));
    EXPECT_THAT(refused([](ModelConfig& c) { c.blend = Blend::smooth; }), HasSubstr("'blend'"));
    EXPECT_THAT(refused([](ModelConfig& c) { c.live_edge = LiveEdge::fade; }),
                HasSubstr("'live_edge'"));
    EXPECT_THAT(refused([](ModelConfig& c) { c.sigma_rule = SigmaRule::mixture; }),
                HasSubstr("'sigma_rule'"));
    EXPECT_THAT(refused([](ModelConfig& c) { c.log_sigma_min = -5; }),
                HasSubstr("'log_sigma_min'"));
    EXPECT_THAT(refused([](ModelConfig& c) { c.gate_radius = 3; }), HasSubstr("'gate_radius'"));
    EXPECT_EQ(refused([](ModelConfig& c) { c.card = c.window = "auto"; }), "not refused");
}

TEST(MeanOfModels, RefusesOtherShapesAndOtherSums) {
    ModelConfig wider = tiny();
    wider.widths = {8, 16};
    const Model one = test::random_model(tiny(), 1), other = test::random_model(wider, 1);
    EXPECT_THROW(mean_of({{one, .5}, {other, .5}}), Error);
    EXPECT_THROW(mean_of({{one, .5}, {one, .4}}), Error);
    EXPECT_THROW(mean_of({{one, .5}, {one, std::nan("")}}), Error);
    EXPECT_THROW(mean_of({}), Error);
}

/// At the end of the third event window of one stream.
Frame frame_of(const Model& model) {
    Encoder encoder{model, 48, 32};
    Renderer renderer{model, 48, 32};
    test::GridStream stream{model.config, 32, 48, 5};
    LatentMap latent = encoder.make_output();
    for (int k = 0; k < 3; ++k) {
        encoder.encode(stream.next(test::GridStream::Kind::patch), latent);
        renderer.push(latent);
    }
    RenderRequest request;
    request.t = latent.window.end;
    Frame frame = renderer.make_output(request);
    renderer.render(request, frame);
    return frame;
}

TEST(Contrast, IsThatOfTheFramesAndOfNothingElse) {
    Model model = test::random_model(tiny(), 1);
    const Frame before = frame_of(model);
    stretch_contrast(model, 1.25, .4);
    const Frame after = frame_of(model);
    const auto expected = before.intensity.values(), found = after.intensity.values();
    for (std::size_t i = 0; i < found.size(); ++i)
        ASSERT_NEAR(found[i], .4 + 1.25 * (expected[i] - .4), 1e-5) << i;
    for (std::size_t i = 0; i < found.size(); ++i)
        ASSERT_NEAR(after.sigma.values()[i], before.sigma.values()[i], 1e-6) << i;
}

TEST(Contrast, IsAGainAboveZeroAroundAnIntensity) {
    Model model = test::random_model(tiny(), 1);
    for (const auto& [gain, around] :
         {std::pair{0., .5}, {-1., .5}, {NAN, .5}, {1., 1.5}, {1., NAN}})
        EXPECT_THROW(stretch_contrast(model, gain, around), Error) << gain << " " << around;
}

}  // namespace
}  // namespace eventide
