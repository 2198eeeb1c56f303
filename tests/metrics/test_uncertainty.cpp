// Sigma judged where it is known to be right, and where it is known to be wrong.
#include "src/metrics/uncertainty.h"

#include "src/core/error.h"
#include "tests/metrics/images.h"
#include "tests/support/error_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numbers>
#include <random>

namespace eventide {
namespace {

/// A truth drawn from N(mu, (true_scale sigma)^2).
struct Drawn {
    Array2<float> mu, sigma, truth;
    explicit Drawn(float true_scale, int height = 200, int width = 300) {
        mu = test_image(height, width, 1);
        sigma = mapped(test_image(height, width, 2), [](float v) { return .02F + .1F * v; });
        truth = mu;
        std::mt19937 random{7};
        std::normal_distribution<float> normal;
        for (std::size_t i = 0; i < truth.values().size(); ++i)
            truth.values()[i] += true_scale * sigma.values()[i] * normal(random);
    }
};

TEST(Coverage, OfGaussianErrorsIsEightTenths) {
    const Drawn drawn{1};
    EXPECT_NEAR(coverage_80(drawn.mu, drawn.sigma, drawn.truth), .80, .005);
}

TEST(Coverage, SeesASigmaThatIsTooSmallOrTooLarge) {
    const Drawn bold{2}, shy{.5};
    EXPECT_LT(coverage_80(bold.mu, bold.sigma, bold.truth), .55);
    EXPECT_GT(coverage_80(shy.mu, shy.sigma, shy.truth), .97);
}

TEST(Coverage, ReachesAsFarAsTheQuantileOfNineTenths) {
    Array2<float> mu(1, 4), sigma(1, 4), truth(1, 4);
    for (int x = 0; x < 4; ++x) {
        sigma(0, x) = .25F;
        mu(0, x) = .5F;
        const float z = x < 2 ? 1.2814F : 1.2817F;  // about 1.28155
        truth(0, x) = .5F + (x % 2 == 0 ? z : -z) * .25F;
    }
    EXPECT_EQ(coverage_80(mu, sigma, truth), .5);
}

TEST(LogLikelihood, IsTheFormula) {
    Array2<float> mu(1, 2), sigma(1, 2), truth(1, 2);
    mu(0, 0) = .25F;
    truth(0, 0) = .5F;
    sigma(0, 0) = .5F;
    mu(0, 1) = truth(0, 1) = .75F;
    sigma(0, 1) = .125F;
    const double expected =
        -.5 * std::log(2 * std::numbers::pi) - .5 * (std::log(.5) + .5 * .25 + std::log(.125));
    EXPECT_NEAR(log_likelihood(mu, sigma, truth), expected, 1e-12);
}

TEST(Coverage, HoldsWhatIsCertainAndRight) {
    Array2<float> mu(1, 2), sigma(1, 2), truth(1, 2);
    truth(0, 1) = .5F;  // certain and wrong
    EXPECT_EQ(coverage_80(mu, sigma, truth), .5);
    Reliability diagram;
    diagram.add(mu, sigma, truth);
    EXPECT_EQ(diagram.inside(0), .5);
}

TEST(LogLikelihood, OfCertaintyIsInfinite) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Array2<float> mu(1, 2), sigma(1, 2), truth(1, 2);
    EXPECT_EQ(log_likelihood(mu, sigma, truth), kInfinity);
    truth(0, 1) = .5F;
    EXPECT_EQ(log_likelihood(mu, sigma, truth), -kInfinity);
}

TEST(LogLikelihood, IsLargestForTheTrueSigma) {
    const Drawn drawn{1};
    const double right = log_likelihood(drawn.mu, drawn.sigma, drawn.truth);
    for (const float scale : {.8F, 1.25F}) {
        const auto wrong = mapped(drawn.sigma, [&](float s) { return s * scale; });
        EXPECT_LT(log_likelihood(drawn.mu, wrong, drawn.truth), right);
    }
}

TEST(Reliability, OfTheTruthLiesOnTheDiagonal) {
    const Drawn drawn{1};
    Reliability diagram;
    diagram.add(drawn.mu, drawn.sigma, drawn.truth);
    EXPECT_EQ(diagram.pixels(), 60000U);
    for (int i = 0; i < Reliability::kLevels; ++i) {
        EXPECT_NEAR(diagram.inside(i), Reliability::level(i), .01);
        EXPECT_NEAR(diagram.below(i), Reliability::level(i), .01);
    }
}

/// Where the standard normal distribution has reached `share`.
double quantile(double share) {
    double low = -4, high = 4;
    for (int i = 0; i < 60; ++i) {
        const double z = (low + high) / 2;
        (std::erfc(-z / std::numbers::sqrt2) / 2 < share ? low : high) = z;
    }
    return low;
}

TEST(Reliability, HasTheQuantilesOfAGaussian) {
    const Array2<float> mu(1, 1);
    Array2<float> sigma(1, 1), truth(1, 1);
    sigma(0, 0) = 1;
    const auto of_one_at = [&](double z) {
        truth(0, 0) = float(z);
        Reliability diagram;
        diagram.add(mu, sigma, truth);
        return diagram;
    };
    for (int i = 0; i < Reliability::kLevels; ++i) {
        const double below = quantile(Reliability::level(i)),
                     inside = quantile(.5 + Reliability::level(i) / 2);
        EXPECT_EQ(of_one_at(below - 1e-6).below(i), 1) << i;
        EXPECT_EQ(of_one_at(below + 1e-6).below(i), 0) << i;
        for (const int side : {-1, 1}) {
            EXPECT_EQ(of_one_at(side * (inside - 1e-6)).inside(i), 1) << i;
            EXPECT_EQ(of_one_at(side * (inside + 1e-6)).inside(i), 0) << i;
        }
    }
}

TEST(Reliability, CountsATruthDarkerThanExpectedAsBelow) {
    Array2<float> mu(1, 1), sigma(1, 1), dark(1, 1), bright(1, 1);
    mu(0, 0) = .5F;
    sigma(0, 0) = .1F;
    bright(0, 0) = 1;
    Reliability diagram;
    diagram.add(mu, sigma, dark);
    EXPECT_EQ(diagram.below(0), 1);
    diagram.add(mu, sigma, bright);
    EXPECT_EQ(diagram.below(Reliability::kLevels - 1), .5);
}

TEST(Coverage, RefusesMapsOfTwoSizesAndOfNone) {
    const Array2<float> map(4, 5), other(5, 4), none;
    EXPECT_NO_THROW(coverage_80(map, map, map));
    EXPECT_EQ(test::error_of([&] { coverage_80(map, other, map); }),
              "mu, sigma and reference: expected images of one size, with pixels, found 5x4, 4x5 "
              "and 5x4");
    EXPECT_THROW(coverage_80(map, map, other), Error);
    EXPECT_THROW(coverage_80(map, map, Array2<float>(4, 4)), Error);
    EXPECT_THROW(coverage_80(none, none, none), Error);
}

TEST(Reliability, SagsWhereSigmaIsTooSmall) {
    const Drawn drawn{2};
    Reliability diagram;
    diagram.add(drawn.mu, drawn.sigma, drawn.truth);
    for (int i = 0; i < Reliability::kLevels; ++i)
        EXPECT_LT(diagram.inside(i), Reliability::level(i));
}

TEST(Reliability, OfTwoPartsIsThatOfTheWhole) {
    const Drawn first{.6F}, second{1.9F};
    Reliability whole, part, sum;
    for (Reliability* each : {&whole, &sum}) each->add(first.mu, first.sigma, first.truth);
    for (Reliability* each : {&whole, &part}) each->add(second.mu, second.sigma, second.truth);
    sum += part;
    EXPECT_EQ(sum.pixels(), whole.pixels());
    for (int i = 0; i < Reliability::kLevels; ++i) {
        EXPECT_EQ(sum.inside(i), whole.inside(i));
        EXPECT_EQ(sum.below(i), whole.below(i));
    }
}

TEST(SigmaScale, FindsTheFactorThatIsMissing) {
    const Drawn drawn{1.7F};
    SigmaScale scale;
    scale.add(drawn.mu, drawn.sigma, drawn.truth);
    EXPECT_NEAR(scale.by_likelihood(), 1.7, .02);
    EXPECT_NEAR(scale.by_coverage(), 1.7, .03);
}

TEST(SigmaScale, ByCoverageIsRightToHalfAPercent) {
    // Errors of one size: 80 % of them are inside where the interval just reaches them.
    Array2<float> mu(3, 4), sigma(3, 4), truth(3, 4);
    std::ranges::fill(sigma.values(), .125F);
    for (float z = .25F; z < 4; z *= 1.0037F) {
        std::ranges::fill(truth.values(), z * .125F);
        SigmaScale scale;
        scale.add(mu, sigma, truth);
        EXPECT_NEAR(scale.by_coverage() * 1.2815516 / double(z), 1, .0052) << z;
    }
}

TEST(SigmaScale, SaysWhatAFactorWillDo) {
    const Drawn drawn{1.3F};
    SigmaScale scale;
    scale.add(drawn.mu, drawn.sigma, drawn.truth);
    for (const float factor : {.7F, 1.F, 1.003F, 1.006F, 1.3F, 2.F}) {
        const Array2<float> sigma = mapped(drawn.sigma, [&](float s) { return factor * s; });
        EXPECT_NEAR(scale.coverage_80_after(double(factor)),
                    coverage_80(drawn.mu, sigma, drawn.truth), .001)
            << factor;
        EXPECT_NEAR(scale.log_likelihood_after(double(factor)),
                    log_likelihood(drawn.mu, sigma, drawn.truth), 1e-5)
            << factor;
    }
}

TEST(SigmaScale, OfTwoPartsIsThatOfTheWhole) {
    const Drawn first{.6F}, second{1.9F};
    SigmaScale whole, part;
    whole.add(first.mu, first.sigma, first.truth);
    whole.add(second.mu, second.sigma, second.truth);
    part.add(second.mu, second.sigma, second.truth);
    SigmaScale sum;
    sum.add(first.mu, first.sigma, first.truth);
    sum += part;
    EXPECT_EQ(sum.pixels(), whole.pixels());
    EXPECT_EQ(sum.by_coverage(), whole.by_coverage());
    EXPECT_NEAR(sum.by_likelihood(), whole.by_likelihood(), 1e-12);
    EXPECT_NEAR(sum.log_likelihood_after(1.1), whole.log_likelihood_after(1.1), 1e-12);
    EXPECT_NEAR(sum.coverage_80_after(1.1), whole.coverage_80_after(1.1), 1e-12);
}

TEST(SigmaScale, IsOneBeforeAnyImage) {
    EXPECT_EQ(SigmaScale{}.by_likelihood(), 1);
    EXPECT_EQ(SigmaScale{}.by_coverage(), 1);
}

TEST(Patches, AreWholeOnesFromTheTopLeft) {
    Array2<float> map(5, 7);
    for (int y = 0; y < 5; ++y)
        for (int x = 0; x < 7; ++x) map(y, x) = float(10 * y + x);
    EXPECT_EQ(patch_means(map, 2), (std::vector<double>{5.5, 7.5, 9.5, 25.5, 27.5, 29.5}));
    EXPECT_EQ(patch_medians(map, 3), (std::vector<double>{11, 14}));
    map(1, 1) = 100;  // of 0, 1, 10 and 100 the middle two
    EXPECT_EQ(patch_medians(map, 2), (std::vector<double>{5.5, 7.5, 9.5, 25.5, 27.5, 29.5}));
    map(1, 1) = 11;
    EXPECT_TRUE(patch_means(map, 6).empty());
    EXPECT_EQ(patch_means(Array2<float>(4, 6), 2).size(), 6U) << "up to the last row and column";
}

}  // namespace
}  // namespace eventide
