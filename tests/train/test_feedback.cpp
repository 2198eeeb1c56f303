// Networks that are fed their own picture.
#include "src/core/error.h"
#include "tests/train/tiny_run.h"

#include <gtest/gtest.h>

namespace eventide {
namespace {

TEST(Training, ANetworkThatIsFedItsOwnPictureGoesOnAsIfItHadNotStopped) {
    for (const char* kind : {"input", "change", "physical"}) {
        SCOPED_TRACE(kind);
        TrainOptions options = tiny_options(empty_folder("fed_whole"));
        OptionTable{options}.set("feedback", kind);
        options.steps = 10;
        const auto whole = expect_stopping_changes_nothing(options, 4);
        const auto& first = whole->parameters().at("encoder.in.weight");
        EXPECT_EQ(first.size(1), 4 * 2 + 2) << "the picture is one more channel than the events";
    }
}

TEST(Training, ANetworkThatIsFedItsOwnPictureIsNotExported) {
    TrainOptions options = tiny_options(empty_folder("fed_export"));
    OptionTable{options}.set("feedback", "change");
    options.export_file = "model.safetensors";
    EXPECT_THROW(trainer(options), Error);
}

/// In an empty world nothing is asked for: a change of 0, a factor of 1.
TEST(Feedback, APictureThatNothingChangesIsHandedOnAsItIs) {
    const ModelConfig config = tiny_options({}).model;
    for (const Feedback feedback : {Feedback::change, Feedback::physical}) {
        Parameters parameters = with_feedback(initial_parameters(config, 1, torch::kCPU), feedback);
        const torch::NoGradGuard none;
        for (auto& [name, values] : parameters)
            if (name.starts_with("renderer.mlp.1")) values.zero_();  // the last layer
        torch::Tensor picture = torch::rand({2, 1, 12, 9}) - kFeedbackGrey;
        const torch::Tensor z = torch::zeros({2, config.latent, 12, 9});
        torch::Tensor next = next_picture(feedback, config, parameters, z, z, picture);
        EXPECT_LT((next - picture).abs().max().item<float>(), 1e-6) << int(feedback);
        parameters.at("renderer.mlp.1.bias")[0] = .25;
        next = next_picture(feedback, config, parameters, z, z, picture);
        EXPECT_GT((next - picture).min().item<float>(), -1e-6) << "brighter, or white already";
        EXPECT_GT((next - picture).mean().item<float>(), .05);
    }
}

TEST(Feedback, APictureIsReadBetweenItsPixelsAndBetweenItsInstants) {
    torch::Tensor ramp = torch::arange(6, torch::kFloat).view({1, 1, 1, 6}).expand({1, 1, 4, 6});
    const Rendered nothing{torch::zeros({1, 2, 3}), torch::zeros({1, 2, 3})};
    const PatchGrid points{.y = {0, 2.5}, .x = {.25, 3, 9}};  // the last beyond the border
    const auto mu = [&](const torch::Tensor& later) {
        const FedPictures fed{ramp, later, torch::full({1}, .25)};
        return apply_feedback(Feedback::change, {}, nothing, {fed}, points).mu - kFeedbackGrey;
    };
    EXPECT_TRUE(torch::allclose(mu({})[0][1], torch::tensor({.25F, 3.F, 5.F})));
    EXPECT_TRUE(torch::allclose(mu(ramp + 1)[0][0], torch::tensor({.5F, 3.25F, 5.25F})));
}

}  // namespace
}  // namespace eventide
