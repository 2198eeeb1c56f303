// A step of Adam and its running mean, by hand.
#include "apps/train/optimiser.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace eventide {
namespace {

/// Two weights, of two names; the gradient's norm is 5.
Optimiser at_start() {
    return {{.beta1 = .9, .beta2 = .99, .epsilon = 1e-8, .clip = 1e9, .ema_decay = .999},
            {{"a", torch::tensor({1.F})}, {"b", torch::tensor({-2.F})}}};
}
Parameters gradients() {
    return {{"a", torch::tensor({3.F})}, {"b", torch::tensor({-4.F})}};
}
double of(const Parameters& parameters, const char* name) {
    return parameters.at(name).item<double>();
}

TEST(Optimiser, IsAdamWithoutItsBias) {
    Optimiser optimiser = at_start();
    EXPECT_NEAR(optimiser.step(gradients(), .1), 5, 1e-6);
    // The first step is the rate, whatever the gradient's size.
    EXPECT_NEAR(of(optimiser.parameters, "a"), 1 - .1, 1e-6);
    EXPECT_NEAR(of(optimiser.parameters, "b"), -2 + .1, 1e-6);
    optimiser.step({{"a", torch::tensor({-1.F})}, {"b", torch::tensor({0.F})}}, .1);
    const double m = (.9 * .1 * 3 - .1 * 1) / (1 - .9 * .9),
                 v = (.99 * .01 * 9 + .01 * 1) / (1 - .99 * .99);
    EXPECT_NEAR(of(optimiser.parameters, "a"), .9 - .1 * m / std::sqrt(v), 1e-6);
}

TEST(Optimiser, ClipsTheNormOfTheWholeGradient) {
    Optimiser optimiser = at_start();
    optimiser.settings.clip = 1;
    EXPECT_NEAR(optimiser.step(gradients(), .1), 5, 1e-6) << "as it was before";
    EXPECT_NEAR(of(optimiser.moment1, "a"), .1 * 3 / 5, 1e-7);
    EXPECT_NEAR(of(optimiser.moment1, "b"), .1 * -4 / 5, 1e-7);
    EXPECT_NEAR(of(optimiser.moment2, "b"), .01 * .64, 1e-7);
    Optimiser small = at_start();
    small.settings.clip = 6;
    small.step(gradients(), .1);
    EXPECT_NEAR(of(small.moment1, "a"), .1 * 3, 1e-7) << "a small one is left as it is";
}

TEST(Optimiser, TheRunningMeanIsShorterWhileFewStepsAreDone) {
    Optimiser optimiser = at_start();
    optimiser.step(gradients(), .1);
    const double first = of(optimiser.parameters, "a"), mean = 1 + (1 - 2. / 11) * (first - 1);
    EXPECT_NEAR(of(optimiser.ema, "a"), mean, 1e-6);
    optimiser.settings.ema_decay = .1;  // shorter still
    optimiser.step(gradients(), .1);
    EXPECT_NEAR(of(optimiser.ema, "a"), mean + (1 - .1) * (of(optimiser.parameters, "a") - mean),
                1e-6);
}

TEST(Optimiser, LeavesAllAsItWasWhereAGradientIsNoNumber) {
    Optimiser optimiser = at_start();
    Parameters wrong = gradients();
    wrong.at("b") = torch::tensor({std::numeric_limits<float>::quiet_NaN()});
    EXPECT_FALSE(std::isfinite(optimiser.step(wrong, .1)));
    EXPECT_EQ(of(optimiser.parameters, "a"), 1);
    EXPECT_EQ(of(optimiser.moment1, "a"), 0);
    EXPECT_EQ(of(optimiser.ema, "a"), 1);
    EXPECT_EQ(optimiser.steps, 0);
}

}  // namespace
}  // namespace eventide
