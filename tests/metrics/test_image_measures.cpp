// Measures between two images: what must hold for any image, then numbers from scikit-image.
#include "src/core/error.h"
#include "src/metrics/image_measures.h"
#include "tests/metrics/images.h"
#include "tests/support/error_of.h"

#include <gtest/gtest.h>

#include <vector>

namespace eventide {
namespace {

using test::error_of;

TEST(ImageMeasures, FindNothingBetweenAnImageAndItself) {
    const auto a = test_image(40, 50, 1);
    EXPECT_EQ(mean_squared_error(a, a), 0);
    EXPECT_NEAR(structural_similarity(a, a), 1, 1e-12);
}

TEST(ImageMeasures, DoNotCareWhichImageComesFirst) {
    const auto a = test_image(40, 50, 1), b = test_image(40, 50, 2);
    EXPECT_EQ(mean_squared_error(a, b), mean_squared_error(b, a));
    EXPECT_NEAR(structural_similarity(a, b), structural_similarity(b, a), 1e-12);
}

TEST(ImageMeasures, DoNotCareWhichWayTheImagesAreTurned) {
    const auto a = test_image(31, 47, 1), b = test_image(31, 47, 2);
    const auto turned = [](const Array2<float>& image) {
        Array2<float> out(image.width(), image.height());
        for (int y = 0; y < image.height(); ++y)
            for (int x = 0; x < image.width(); ++x) out(x, image.height() - 1 - y) = image(y, x);
        return out;
    };
    EXPECT_NEAR(structural_similarity(a, b), structural_similarity(turned(a), turned(b)), 1e-12);
    EXPECT_NEAR(mean_squared_error(a, b), mean_squared_error(turned(a), turned(b)), 1e-12);
}

TEST(MeanSquaredError, OfAConstantOffsetIsItsSquare) {
    const auto a = mapped(test_image(20, 20, 1), [](float v) { return .5F * v; });
    EXPECT_NEAR(mean_squared_error(a, mapped(a, [](float v) { return v + .25F; })), .0625, 1e-6);
}

TEST(StructuralSimilarity, IsScikitImages) {
    struct Golden {
        int height, width;
        double unlike, gain, noise;
    };
    // make_ssim_golden.py
    for (const Golden& golden :
         {Golden{48, 64, 0.20660796980241627, 0.9682299138521795, 0.9946632199807309},
          Golden{11, 11, 0.18001006105457526, 0.9788062337246027, 0.992340523593897},
          Golden{37, 29, 0.22467395352591857, 0.9731977037200843, 0.9947488536098166}}) {
        const auto a = test_image(golden.height, golden.width, 1);
        const auto b = test_image(golden.height, golden.width, 2);
        const auto gain = mapped(a, [](float v) { return std::clamp(.8F * v + .15F, 0.F, 1.F); });
        auto noise = a;
        for (std::size_t i = 0; i < noise.values().size(); ++i)
            noise.values()[i] = std::clamp(a.values()[i] + .1F * (b.values()[i] - .5F), 0.F, 1.F);
        EXPECT_NEAR(structural_similarity(a, b), golden.unlike, 1e-5);
        EXPECT_NEAR(structural_similarity(a, gain), golden.gain, 1e-5);
        EXPECT_NEAR(structural_similarity(a, noise), golden.noise, 1e-5);
    }
}

TEST(StructuralSimilarity, OfFlatImagesIsThatOfTheirMeans) {
    const auto flat = [](float v) {
        return mapped(Array2<float>(11, 11), [v](float) { return v; });
    };
    EXPECT_NEAR(structural_similarity(flat(0), flat(.01F)), .5, 1e-6) << "K1 = .01";
}

TEST(StructuralSimilarity, RefusesImagesItsWindowDoesNotFit) {
    for (const auto& small : {test_image(10, 50, 1), test_image(50, 10, 1)})
        EXPECT_THROW(structural_similarity(small, small), Error);
}

TEST(ImageMeasures, RefuseImagesOfTwoSizesAndOfNone) {
    EXPECT_EQ(error_of([] { mean_squared_error(test_image(20, 20, 1), test_image(20, 21, 1)); }),
              "two images to compare: expected the same size, found 20x20 and 21x20");
    EXPECT_THROW(structural_similarity(test_image(20, 20, 1), test_image(21, 20, 1)), Error);
    EXPECT_EQ(error_of([] { mean_squared_error(Array2<float>(0, 5), Array2<float>(0, 5)); }),
              "two images to compare: expected pixels, found 5x0");
}

TEST(AffineFit, UndoesGainAndOffset) {
    const auto truth = test_image(30, 40, 3);
    const auto changed = mapped(truth, [](float v) { return (v - .1F) / 1.7F; });
    const AffineFit fit = affine_fit(changed, truth);
    EXPECT_NEAR(fit.gain, 1.7, 1e-5);
    EXPECT_NEAR(fit.offset, .1, 1e-5);
    EXPECT_NEAR(mean_squared_error(applied(fit, changed), truth), 0, 1e-11);
}

TEST(AffineFit, BringsOutWhatIsFaint) {
    const auto truth = test_image(30, 40, 3);
    const auto faint = mapped(truth, [](float v) { return .4F + .002F * v; });
    EXPECT_NEAR(affine_fit(faint, truth).gain, 500, .5);
    EXPECT_NEAR(*correlation(spread(faint, truth)), 1, 1e-4);
}

TEST(AffineFit, TakesRoundingForNoContrast) {
    const auto truth = test_image(30, 40, 3);
    const auto contrast = [&](float c) {
        return mapped(truth, [c](float v) { return .4F + c * v; });
    };
    EXPECT_NEAR(affine_fit(contrast(2e-5F), truth).gain, 5e4, 1e3);
    EXPECT_EQ(affine_fit(contrast(6e-8F), truth).gain, 0);
    EXPECT_EQ(correlation(spread(truth, contrast(6e-8F))), std::nullopt);
}

TEST(AffineFit, IsNeverWorseThanTheRawImage) {
    for (int seed = 1; seed < 6; ++seed) {
        const auto a = test_image(30, 40, seed), b = test_image(30, 40, seed + 7);
        EXPECT_LE(mean_squared_error(applied(affine_fit(a, b), a), b),
                  mean_squared_error(a, b) + 1e-9);
    }
}

TEST(AffineFit, GivesAFlatImageTheMean) {
    const auto truth = test_image(30, 40, 3);
    const auto flat = mapped(truth, [](float) { return .9F; });
    const AffineFit fit = affine_fit(flat, truth);
    EXPECT_EQ(fit.gain, 0);
    EXPECT_LT(mean_squared_error(applied(fit, flat), truth), mean_squared_error(flat, truth));
}

TEST(Correlation, IsOneForGainAndOffsetAndNothingForAFlatImage) {
    const auto truth = test_image(30, 40, 3);
    EXPECT_NEAR(*correlation(spread(mapped(truth, [](float v) { return .1F + .3F * v; }), truth)),
                1, 1e-6);
    EXPECT_NEAR(*correlation(spread(mapped(truth, [](float v) { return 1 - v; }), truth)), -1,
                1e-6);
    EXPECT_EQ(correlation(spread(mapped(truth, [](float) { return .9F; }), truth)), std::nullopt);
    EXPECT_THROW(spread(test_image(20, 20, 1), test_image(20, 21, 1)), Error);
}

TEST(Correlation, SaysWhatAnAffineFitLeaves) {
    const auto a = test_image(30, 40, 3), b = test_image(30, 40, 9);
    const double r = *correlation(spread(a, b));
    const auto mean = applied(affine_fit(mapped(b, [](float) { return 0.F; }), b), b);
    EXPECT_NEAR(mean_squared_error(applied(affine_fit(a, b), a), b),
                (1 - r * r) * mean_squared_error(mean, b), 1e-8);
}

TEST(Clipped, BringsAnythingIntoZeroToOne) {
    Array2<float> image(1, 6);
    image(0, 0) = -3;
    image(0, 1) = 3;
    image(0, 4) = -.001F;
    image(0, 5) = 1.001F;
    image(0, 2) = std::nanf("");
    image(0, 3) = .25F;
    const auto out = clipped(image);
    EXPECT_EQ(out(0, 0), 0);
    EXPECT_EQ(out(0, 1), 1);
    EXPECT_EQ(out(0, 2), 0);
    EXPECT_EQ(out(0, 3), .25F);
    EXPECT_EQ(out(0, 4), 0);
    EXPECT_EQ(out(0, 5), 1);
}

TEST(Correlation, IsOneForALineMinusOneForAFallingOneAndNothingForAConstant) {
    const std::vector<double> a{1, 2, 4, 8};
    const auto with = [&](const std::vector<double>& b) { return correlation(spread(a, b)); };
    EXPECT_NEAR(*with({3, 5, 9, 17}), 1, 1e-12);
    EXPECT_NEAR(*with({-1, -2, -4, -8}), -1, 1e-12);
    EXPECT_FALSE(with({.1, .1, .1, .1}));
    EXPECT_FALSE(correlation(spread(std::vector{1.}, std::vector{1.})));
    EXPECT_FALSE(correlation(spread(std::vector<double>{}, std::vector<double>{})));
    EXPECT_THROW(with({1}), Error);
}

}  // namespace
}  // namespace eventide
