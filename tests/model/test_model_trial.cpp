// Networks whose weights are finite but whose frames are not are refused by name.
#include "src/core/error.h"
#include "src/model/model_trial.h"
#include "tests/model/streams.h"
#include "tests/support/random_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace eventide {
namespace {

TEST(ModelTrial, SoundNetworksPass) {
    for (const ModelConfig& config : {test::small_config(), test::thesis_config()})
        for (const std::uint64_t seed : {1U, 2U, 3U})
            EXPECT_NO_THROW(try_model(test::random_model(config, seed), "sound"));
}

TEST(ModelTrial, WeightsThatAreTooLargeTogetherAreRefused) {
    for (const ModelConfig& config : {test::small_config(), test::thesis_config()}) {
        Model model = test::random_model(config, 1);
        for (auto& [name, tensor] : model.weights)
            for (float& value : tensor.values) value *= 1e30F;
        ASSERT_NO_THROW(check_model(model, "huge")) << "each of them is finite";
        try {
            try_model(model, "huge.safetensors");
            FAIL() << "was taken";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::input);
            EXPECT_THAT(error.what(), testing::HasSubstr("huge.safetensors: expected a network"));
        }
    }
}

/// Frames at the live edge do not read what comes after their window.
TEST(ModelTrial, WeightsThatAreTooLargeForCodesOfLaterWindowsAreRefused) {
    for (const int unfold : {1, 3}) {
        ModelConfig config = test::small_config();
        config.unfold = unfold;
        Model model = test::random_model(config, 1);
        Tensor& first = model.weights.at("renderer.mlp.0.weight");
        const auto inputs = std::size_t(first.shape[1]), codes = (inputs - 3) / 3;
        for (std::size_t i = 0; i < first.values.size(); ++i)
            if (i % inputs >= 2 * codes && i % inputs < 3 * codes) first.values[i] *= 1e30F;
        EXPECT_THROW(try_model(model, "huge"), Error) << unfold;
    }
}

TEST(ModelTrial, OneNumberThatIsNoneIsSeenWhereverItIs) {
    for (const float bad :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
          -std::numeric_limits<float>::infinity()})
        for (const int x : {0, 1, 16}) {
            Array2<float> map(3, 17);
            for (float& value : map.values()) value = 3e38F;
            EXPECT_TRUE(is_finite(map));
            map(2, x) = bad;
            EXPECT_FALSE(is_finite(map));
        }
    EXPECT_TRUE(is_finite({}));
}

}  // namespace
}  // namespace eventide
