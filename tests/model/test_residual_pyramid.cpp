// What a correction of frames keeps while the scene stands still, and loses where it moves.
#include "src/model/render/residual_pyramid.h"

#include "src/model/render/half_maps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace eventide {
namespace {

Array2<float> constant(int height, int width, float value) {
    Array2<float> map(height, width);
    std::ranges::fill(map.values(), value);
    return map;
}

Array2<float> noise(int height, int width, std::uint32_t seed) {
    std::mt19937 random{seed};
    std::normal_distribution<float> normal;
    Array2<float> map(height, width);
    for (float& v : map.values()) v = normal(random);
    return map;
}

struct Expectation {
    Array2<float> correction, variance;
};
Expectation expect(ResidualPyramid& pyramid, const Array2<float>& residual) {
    const int height = residual.height(), width = residual.width();
    Expectation e{Array2<float>(height, width), Array2<float>(height, width)};
    pyramid.correct(residual, e.correction);
    pyramid.variance(e.variance);
    return e;
}

ResidualPyramid observed(int height, int width, float trust = 1) {
    ResidualPyramid pyramid{width, height};
    pyramid.observe(constant(height, width, trust), constant(height, width, 0));
    return pyramid;
}

TEST(ResidualPyramid, HalvingAndDoublingKeepAPlainSurface) {
    for (const auto& [height, width] : {std::pair{1, 1}, {1, 7}, {5, 1}, {8, 8}, {17, 13}}) {
        const Array2<float> plain = constant(height, width, .7F);
        Array2<float> half((height + 1) / 2, (width + 1) / 2), back = constant(height, width, 0);
        halve(plain, half);
        add_doubled(half, back);
        for (const float v : half.values()) EXPECT_FLOAT_EQ(v, .7F);
        for (const float v : back.values()) EXPECT_FLOAT_EQ(v, .7F);
    }
}

TEST(ResidualPyramid, DoublingARampGivesARampBetweenTheOutermostCentres) {
    Array2<float> half(1, 8), whole(1, 16);
    for (int x = 0; x < 8; ++x) half(0, x) = float(x);
    add_doubled(half, whole);
    for (int x = 1; x < 15; ++x) EXPECT_FLOAT_EQ(whole(0, x), (float(x) + .5F) / 2 - .5F);
}

TEST(ResidualPyramid, KnowsNothingBeforeTheFirstObservation) {
    ResidualPyramid pyramid{20, 10};
    pyramid.forget(constant(10, 20, 3));
    const Expectation e = expect(pyramid, constant(10, 20, 0));
    for (const float v : e.correction.values()) EXPECT_EQ(v, 0);
    for (const float v : e.variance.values()) EXPECT_NEAR(v, 1, 1e-6);
}

TEST(ResidualPyramid, GivesBackWhatWasSeenWhileNothingHappens) {
    for (const auto& [height, width] : {std::pair{1, 1}, {1, 33}, {31, 17}, {96, 120}}) {
        const Array2<float> residual = noise(height, width, 1);
        ResidualPyramid pyramid = observed(height, width);
        for (int i = 0; i < 1000; ++i) pyramid.forget(constant(height, width, 0));
        const Expectation e = expect(pyramid, residual);
        for (std::size_t i = 0; i < residual.values().size(); ++i) {
            ASSERT_NEAR(e.correction.values()[i], residual.values()[i], 1e-5) << width;
            ASSERT_NEAR(e.variance.values()[i], 0, 1e-6);
        }
    }
}

TEST(ResidualPyramid, FineStructureIsForgottenBeforeCoarse) {
    const int size = 64;
    Array2<float> fine(size, size), coarse(size, size);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            fine(y, x) = (x + y) % 2 == 0 ? 1.F : -1.F;
            coarse(y, x) = x < size / 2 ? 1.F : -1.F;
        }
    const auto left = [&](const Array2<float>& residual) {
        ResidualPyramid pyramid = observed(size, size);
        pyramid.forget(constant(size, size, 1.5F));
        return expect(pyramid, residual).correction(20, 10) / residual(20, 10);
    };
    EXPECT_LT(left(fine), .1);
    EXPECT_GT(left(coarse), .8);
}

TEST(ResidualPyramid, IsForgottenWhereThingsMoveAlone) {
    const int size = 64;
    const Array2<float> residual = noise(size, size, 2);
    ResidualPyramid pyramid = observed(size, size);
    Array2<float> events = constant(size, size, 0);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < 8; ++x) events(y, x) = 5;
    pyramid.forget(events);
    const Expectation e = expect(pyramid, residual);
    double here = 0, there = 0;
    for (int y = 0; y < size; ++y) {
        here += e.variance(y, 3);
        there += e.variance(y, size - 4);
    }
    EXPECT_GT(here / size, .4);
    EXPECT_LT(there / size, .05);
}

TEST(ResidualPyramid, VarianceOnlyGrowsWithEventsAndNeverBeyondTheModels) {
    const int size = 40;
    ResidualPyramid pyramid = observed(size, size);
    float before = 0;
    for (int i = 0; i < 60; ++i) {
        pyramid.forget(constant(size, size, 1));
        const float now = expect(pyramid, constant(size, size, 0)).variance(20, 20);
        EXPECT_GE(now, before - 1e-6F);
        EXPECT_LE(now, 1 + 1e-5F);
        before = now;
    }
    EXPECT_GT(before, .8F);
}

/// left = sum over 7 bands of 1/7 (1 - (u rho_k)^2), rho_k = exp(-2 n / 2^k)
TEST(ResidualPyramid, VarianceIsThatOfTheFormula) {
    constexpr int kHeight = 130, kWidth = 200;
    const auto left = [](double trust, double n) {
        double sum = 0;
        for (int k = 0; k < 7; ++k)
            sum += (1 - std::pow(trust * std::exp(-2 * n / (1 << k)), 2)) / 7;
        return sum;
    };
    const auto found = [](ResidualPyramid& pyramid) {
        return expect(pyramid, constant(kHeight, kWidth, 0)).variance(60, 100);
    };
    for (const float trust : {1.F, .5F}) {
        ResidualPyramid pyramid = observed(kHeight, kWidth, trust);
        EXPECT_NEAR(found(pyramid), left(trust, 0), 1e-5);
        pyramid.forget(constant(kHeight, kWidth, .4F));
        EXPECT_NEAR(found(pyramid), left(trust, .4), 1e-5);
        pyramid.observe(constant(kHeight, kWidth, 0), constant(kHeight, kWidth, 0));
        EXPECT_NEAR(found(pyramid), left(trust, .4), 1e-5) << "an image that tells nothing";
        pyramid.forget(constant(kHeight, kWidth, .1F));
        EXPECT_NEAR(found(pyramid), left(trust, .5), 1e-5);
        pyramid.reset();
        pyramid.observe(constant(kHeight, kWidth, 1), constant(kHeight, kWidth, 0));
        pyramid.forget(constant(kHeight, kWidth, .1F));
        EXPECT_NEAR(found(pyramid), left(1, .1), 1e-5) << "nothing of before";
    }
}

/// c_k = min(1, 4 w_k), c_0 = w_0
TEST(ResidualPyramid, WhatIsLessKnownCountsLessInTheFinestBandAlone) {
    constexpr int kSize = 32;
    ResidualPyramid pyramid = observed(kSize, kSize);
    Array2<float> fine(kSize, kSize), coarse(kSize, kSize);
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            fine(y, x) = (x + y) % 2 == 0 ? 1.F : -1.F;
            coarse(y, x) = .3F;
        }
    for (const float known : {1.F, .5F, .25F}) {
        pyramid.know(constant(kSize, kSize, known));
        EXPECT_NEAR(expect(pyramid, fine).correction(16, 16), known, 1e-5);
        EXPECT_NEAR(expect(pyramid, coarse).correction(16, 16), .3F, 1e-5);
    }
    pyramid.know(constant(kSize, kSize, .1F));
    // Of five bands, down to 2 px, each leaves a share of 1 - c_k.
    EXPECT_NEAR(expect(pyramid, coarse).correction(16, 16), .3 * (1 - .9 * std::pow(1 - 4 * .1, 4)),
                1e-5);
}

TEST(ResidualPyramid, WhatCannotBeTrustedLeavesTheOldKnowledge) {
    const int size = 32;
    const Array2<float> residual = noise(size, size, 4);
    ResidualPyramid pyramid = observed(size, size);
    pyramid.observe(constant(size, size, 0), constant(size, size, 100));
    const Expectation e = expect(pyramid, residual);
    // Known as before, but with the events that came since: fine bands are gone, the mean is not.
    for (const float v : e.variance.values()) EXPECT_GT(v, .3F);
    ResidualPyramid ignorant = observed(size, size, 0);
    const Expectation nothing = expect(ignorant, residual);
    for (const float v : nothing.variance.values()) EXPECT_NEAR(v, 1, 1e-5);
}

TEST(ResidualPyramid, WhereNothingIsKnownWhatIsKnownAroundGoesOn) {
    const int size = 64;
    Array2<float> residual = constant(size, size, .2F), trust = constant(size, size, 1);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < 20; ++x) {
            residual(y, x) = 9;  // wrong, and known to be
            trust(y, x) = 0;
        }
    ResidualPyramid pyramid = observed(size, size);
    pyramid.know(trust);
    const Expectation e = expect(pyramid, residual);
    for (const float v : e.correction.values()) EXPECT_NEAR(v, .2F, 1e-4);
    pyramid.know(constant(size, size, 0));
    const Expectation nothing = expect(pyramid, residual);
    for (const float v : nothing.correction.values()) EXPECT_EQ(v, 0);
}

TEST(ResidualPyramid, VarianceIsTheModelsWhereNothingIsKnownNow) {
    const int size = 64;
    Array2<float> where = constant(size, size, 1);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < 32; ++x) where(y, x) = 0;
    ResidualPyramid pyramid = observed(size, size);
    pyramid.know(where);
    const Array2<float> left = expect(pyramid, constant(size, size, .2F)).variance;
    EXPECT_GT(left(32, 2), .7F) << "but for the coarsest bands";
    EXPECT_LT(left(32, 61), .1F);
    pyramid.know(constant(size, size, 0));
    const Expectation nothing = expect(pyramid, constant(size, size, .2F));
    for (const float v : nothing.variance.values()) EXPECT_NEAR(v, 1, 1e-5);
}

/// Frames at the end of a window and at the begin of the next are alike.
TEST(ResidualPyramid, WhereItIsKnownChangesLinearlyInTime) {
    const int size = 32;
    const Array2<float> residual = noise(size, size, 5);
    ResidualPyramid pyramid = observed(size, size);
    const auto at = [&](float time) {
        Array2<float> correction(size, size);
        pyramid.correct(residual, correction, time);
        return correction(16, 16);
    };
    pyramid.know(constant(size, size, .8F));
    pyramid.forget(constant(size, size, .1F));
    pyramid.know(constant(size, size, .8F));
    const float before = at(1);
    pyramid.forget(constant(size, size, 0));
    pyramid.know(constant(size, size, 0));
    EXPECT_FLOAT_EQ(at(0), before);
    EXPECT_NE(at(.5F), 0);
    EXPECT_EQ(at(1), 0);
}

}  // namespace
}  // namespace eventide
