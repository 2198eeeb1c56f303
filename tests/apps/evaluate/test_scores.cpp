// What a frame's scores mean, on images small enough to be judged by hand.
#include "apps/evaluate/scores.h"
#include "src/core/error.h"
#include "src/metrics/image_measures.h"
#include "tests/metrics/images.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace eventide {
namespace {

constexpr int kSide = 12;

/// Four stripes, three columns of each value.
Array2<float> stripes(const std::array<float, 4>& values) {
    Array2<float> image(kSide, kSide);
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) image(y, x) = values[std::size_t(x / 3)];
    return image;
}

Array2<float> all_of(float value) {
    return stripes({value, value, value, value});
}

TEST(Judge, ClipsBeforeItComparesAndBeforeItFits) {
    const FrameScores scores =
        Judge{nullptr}.judge(stripes({-.5F, .25F, .5F, 3}), {}, stripes({0, .5F, 1, 1}));
    // Shown are 0, .25, .5 and 1.
    EXPECT_NEAR(scores.raw.mse, (.0625 + .25) / 4, 1e-7);
    // Gain .13281 / .13672, offset .2: the last stripe would be 1.17, and is cut at 1.
    EXPECT_NEAR(scores.affine.mse, (.04 + .0032653 + .0987755 + 0) / 4, 1e-6);
    EXPECT_NEAR(*scores.correlation, .1328125 / std::sqrt(.13671875 * .171875), 1e-6);
    EXPECT_FALSE(scores.picp80 || scores.ll || scores.mean_sigma || scores.lpips_corr);
    EXPECT_FALSE(scores.raw.lpips || scores.affine.lpips);
}

TEST(Judge, AFitOfALineLeavesNothing) {
    const FrameScores scores =
        Judge{nullptr}.judge(stripes({.4F, .5F, .6F, .7F}), {}, stripes({.1F, .3F, .5F, .7F}));
    EXPECT_NEAR(scores.raw.mse, (.09 + .04 + .01) / 4, 1e-7);
    EXPECT_NEAR(scores.affine.mse, 0, 1e-10);
    EXPECT_NEAR(*scores.correlation, 1, 1e-6);
}

TEST(Judge, SigmaIsThatOfTheClippedFrame) {
    // Errors of the four stripes, over sigma: 0, 1.281, 1.282 and 2.
    const FrameScores scores = Judge{nullptr}.judge(stripes({-1, .1281F, .1282F, .5F}),
                                                    stripes({.1F, .1F, .1F, .25F}), all_of(0));
    EXPECT_EQ(*scores.picp80, .5);
    EXPECT_NEAR(*scores.mean_sigma, .1375, 1e-7);
    const double z2 = (1.281 * 1.281 + 1.282 * 1.282 + 4) / 4,
                 ln_sigma = (3 * std::log(.1) + std::log(.25)) / 4;
    EXPECT_NEAR(*scores.ll, -.5 * std::log(2 * std::numbers::pi) - ln_sigma - .5 * z2, 1e-5);
}

TEST(Judge, MeanSigmaIsThatOfEveryPixelOfAWideImage) {
    Array2<float> wide(12, 24), sigma(12, 24);
    std::ranges::fill(sigma.values(), .2F);
    EXPECT_NEAR(*Judge{nullptr}.judge(wide, sigma, wide).mean_sigma, .2, 1e-6);
}

TEST(Judge, SumsUpWhatFiguresShow) {
    Judge judge{nullptr};
    judge.judge(all_of(.5F), all_of(.1F), stripes({.5F, .6F, .7F, .8F}));
    const Observations& seen = judge.observations();
    EXPECT_EQ(seen.reliability.pixels(), 144U);
    EXPECT_EQ(seen.reliability.below(9), .25) << "below the median: where there is no error";
    // Mean of z^2: (0 + 1 + 4 + 9) / 4.
    EXPECT_NEAR(seen.sigma_scale.by_likelihood(), std::sqrt(3.5), 1e-5);
    std::uint64_t pixels = 0;
    for (const Observations::SigmaBin& bin : seen.sigma_bins) {
        if (bin.pixels == 0) continue;
        pixels += bin.pixels;
        EXPECT_NEAR(bin.sigma / double(bin.pixels), .1, 1e-6);
        EXPECT_NEAR(bin.squared_error / double(bin.pixels), (.01 + .04 + .09) / 4, 1e-6);
    }
    EXPECT_EQ(pixels, 144U);
    Observations twice = seen;
    twice += seen;
    EXPECT_EQ(twice.reliability.pixels(), 288U);
    EXPECT_NEAR(twice.sigma_scale.by_likelihood(), std::sqrt(3.5), 1e-5);
}

TEST(Judge, SortsPixelsBySigmaIntoBinsOfEqualRatio) {
    Judge judge{nullptr};
    judge.judge(all_of(.5F), stripes({.004F, .06F, .08F, 2}), all_of(.5F));
    // ln(sigma / .005) / ln 200 of 24: below 0, 11.3, 12.6, above 24.
    for (int bin = 0; bin < Observations::kSigmaBins; ++bin)
        EXPECT_EQ(judge.observations().sigma_bins[std::size_t(bin)].pixels,
                  bin == 0 || bin == 11 || bin == 12 || bin == 23 ? 36U : 0U)
            << bin;
}

TEST(Observations, OfTwoSequencesAreTheirSums) {
    Observations one, other, none;
    one.patch_sizes = {{8, .5, .25, 1}, {12, .25, .0625, 1}};
    other.patch_sizes = {{8, 1, .5, 2}, {12, 0, 0, 0}};
    one.patch_bins[3] = {.1, .5, 2};
    other.patch_bins[3] = {.2, .25, 4};
    one += other;
    one += none;
    none += one;  // into those that have seen nothing yet
    for (const Observations* sum : {&one, &none}) {
        ASSERT_EQ(sum->patch_sizes.size(), 2U);
        const Observations::PatchSize& first = sum->patch_sizes[0];
        EXPECT_EQ(first.size, 8);
        EXPECT_EQ(first.sum, 1.5);
        EXPECT_EQ(first.squares, .75);
        EXPECT_EQ(first.frames, 3);
        EXPECT_EQ(sum->patch_sizes[1].frames, 1);
        EXPECT_DOUBLE_EQ(sum->patch_bins[3].sigma, .3);
        EXPECT_EQ(sum->patch_bins[3].lpips, .75);
        EXPECT_EQ(sum->patch_bins[3].patches, 6U);
    }
}

TEST(Judge, ErrorsNameWhatWasJudged) {
    Judge judge{nullptr};
    try {
        judged("desk", judge, all_of(0), {}, Array2<float>(4, 5));
        FAIL() << "images of two sizes";
    } catch (const Error& error) {
        EXPECT_EQ(std::string{error.what()},
                  "desk: two images to compare: expected the same size, found 12x12 and 5x4");
    }
}

TEST(MeanScores, WeighFramesEquallyAndLeaveOutWhatSomeHaveNot) {
    std::vector<FrameScores> frames(3);
    frames[0].raw = {.mse = .1, .ssim = .9, .lpips = .2};
    frames[1].raw = {.mse = .3, .ssim = .5, .lpips = {}};
    frames[2].raw = {.mse = .2, .ssim = .4, .lpips = .6};
    frames[0].affine.mse = .03;
    frames[1].lpips_corr = .5;
    const SequenceScores mean = mean_scores("three", frames);
    EXPECT_EQ(mean.frames, 3);
    EXPECT_NEAR(mean.raw.mse, .2, 1e-12);
    EXPECT_NEAR(mean.raw.ssim, .6, 1e-12);
    EXPECT_NEAR(*mean.raw.lpips, .4, 1e-12);
    EXPECT_NEAR(mean.affine.mse, .01, 1e-12);
    EXPECT_EQ(*mean.lpips_corr, .5);
    EXPECT_FALSE(mean.picp80 || mean.ll || mean.mean_sigma || mean.correlation);
    EXPECT_TRUE(std::isnan(mean_scores("none", {}).raw.mse));
}

TEST(Judge, CorrelatesPatchesOf16PixelsWithTheirMedianSigma) {
    const std::filesystem::path weights = shared_data() / "perceptual" / "lpips_squeeze_v0.1.npz";
    if (!exists(weights)) GTEST_SKIP() << "no LPIPS weights: " << weights << " is absent";
    const Lpips lpips{weights};
    const Array2<float> frame = test_image(72, 90, 1), truth = test_image(72, 90, 2),
                        sigma = test_image(72, 90, 3);
    Judge judge{&lpips};
    const FrameScores scores = judge.judge(frame, sigma, truth);
    const auto map = lpips.distance_map(lpips.features(frame), lpips.features(truth));
    const auto errors = patch_means(map, 16), doubts = patch_medians(sigma, 16);
    ASSERT_EQ(errors.size(), 20U);  // 4 x 5
    EXPECT_NEAR(*scores.lpips_corr, *correlation(spread(errors, doubts)), 1e-9);
    EXPECT_NEAR(*scores.raw.lpips, lpips.distance(lpips.features(frame), lpips.features(truth)),
                1e-9);
    const Array2<float> fitted = clipped(applied(affine_fit(frame, truth), frame));
    EXPECT_NEAR(*scores.affine.lpips, lpips.distance(lpips.features(fitted), lpips.features(truth)),
                1e-9);
    const Observations::PatchSize& of_16 = judge.observations().patch_sizes[2];
    EXPECT_EQ(of_16.size, 16);
    EXPECT_NEAR(of_16.sum, *scores.lpips_corr, 1e-12);
    EXPECT_NEAR(of_16.squares, *scores.lpips_corr * *scores.lpips_corr, 1e-12);
    std::uint64_t patches = 0;
    for (const Observations::PatchBin& bin : judge.observations().patch_bins)
        patches += bin.patches;
    EXPECT_EQ(patches, 20U);
    EXPECT_EQ(judge.observations().patch_sizes.front().size, 8);
    EXPECT_EQ(judge.observations().patch_sizes.back().size, 96);
}

}  // namespace
}  // namespace eventide
