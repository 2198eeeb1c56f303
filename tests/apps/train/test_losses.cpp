// The measures that training makes small are those that evaluation reports.
#include "apps/train/network/losses.h"
#include "src/metrics/image_measures.h"

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include <filesystem>

namespace eventide {
namespace {

namespace fs = std::filesystem;
const fs::path kPerceptual = fs::path{EVENTIDE_SOURCE_DIR} / "../shared/data/perceptual";

torch::Tensor test_image(int height, int width, int seed) {
    torch::manual_seed(seed);
    return torch::rand({1, height, width});
}

Array2<float> as_array(const torch::Tensor& image) {
    Array2<float> array{int(image.size(1)), int(image.size(2))};
    std::copy_n(image.contiguous().data_ptr<float>(), array.values().size(),
                array.values().begin());
    return array;
}

/// The weights of some terms; the others count nothing.
struct Only {
    double l1 = 0, l2 = 0, ssim = 0, lpips = 0, nll = 0, temporal = 0, contrast = 0;
};
LossWeights only(const Only& w) {
    return {w.l1, w.l2, w.ssim, w.lpips, w.nll, w.temporal, w.contrast};
}

TEST(Losses, SsimIsThatOfEvaluation) {
    const auto a = test_image(40, 53, 1), b = 0.7 * a + 0.3 * test_image(40, 53, 2);
    EXPECT_NEAR(ssim(a, b).item<double>(), structural_similarity(as_array(a), as_array(b)), 1e-4);
    EXPECT_NEAR(ssim(a, a).item<double>(), 1, 1e-5);
}

TEST(Losses, ContrastLooksAtTheImageAsAWholeAndNotAtItsBrightness) {
    const auto truth = test_image(40, 53, 1);
    const auto of = [&](const torch::Tensor& mu) {
        return whole_contrast(mu, truth).item<double>();
    };
    EXPECT_NEAR(of(truth), 1, 1e-5);
    EXPECT_NEAR(of(truth + 0.3), 1, 1e-5) << "brighter";
    EXPECT_NEAR(of(0.25 + 0.5 * (truth - truth.mean())), 2 * 0.5 / (1 + 0.25), 0.01) << "fainter";
    EXPECT_NEAR(of(-truth), -1, 0.03) << "a negative";
    EXPECT_NEAR(of(torch::full_like(truth, 0.4)), 0, 0.03) << "grey";
}

TEST(Losses, ContrastAloneFillsAGreySurface) {
    auto truth = torch::zeros({1, 64, 64});
    truth.narrow(2, 0, 32).fill_(0.6);
    auto mu = torch::full({1, 64, 64}, 0.3);
    mu.select(2, 31).fill_(0.5);  // only its edge is told
    mu.select(2, 32).fill_(0.1);
    mu.set_requires_grad(true);
    const auto s = torch::zeros({1, 64, 64});
    loss({mu, s, truth, torch::ones({1})}, only({.contrast = 1}), nullptr, 1).total.backward();
    const auto inside = mu.grad().select(1, 32);
    EXPECT_LT(inside[0][4].item<double>(), 0) << "far inside the bright half: brighter";
    EXPECT_GT(inside[0][60].item<double>(), 0) << "far inside the dark half: darker";
}

TEST(Losses, APerfectImageCostsNothingButSigma) {
    const auto truth = test_image(32, 32, 3);
    const Images images{truth.clone(), torch::full({1, 32, 32}, -2.0), truth, torch::ones({1})};
    const LossTerms terms = loss(images, {}, nullptr, 1);
    EXPECT_NEAR(terms.means[0], 0, 1e-6);   // L1
    EXPECT_NEAR(terms.means[1], 0, 1e-5);   // 1 - SSIM
    EXPECT_NEAR(terms.means[3], -2, 1e-6);  // ln sigma
    EXPECT_EQ(terms.means[6], 1);           // all within 1.28 sigma
}

TEST(Losses, SigmaLearnsTheSizeOfErrorsAndNeverMovesTheImage) {
    const auto truth = torch::zeros({1, 32, 32});
    const auto mu = torch::full({1, 32, 32}, 0.25).set_requires_grad(true);
    const auto s = torch::full({1, 32, 32}, std::log(0.25)).set_requires_grad(true);
    loss({mu, s, truth, torch::ones({1})}, only({.nll = 1}), nullptr, 1).total.backward();
    EXPECT_NEAR(s.grad().abs().max().item<double>(), 0, 1e-9) << "sigma = |error| is the best";
    EXPECT_TRUE(!mu.grad().defined() || mu.grad().abs().max().item<double>() == 0);
}

TEST(Losses, WhatIsTaughtDrawsTheImageAndTheTruthAnswersForSigma) {
    const auto truth = test_image(32, 32, 6), taught = test_image(32, 32, 7);
    const auto s = torch::full({1, 32, 32}, -1.0);
    const auto terms = [&](const torch::Tensor& mu) {
        Images images{mu, s, truth, torch::ones({1})};
        images.taught = taught;
        return loss(images, {.contrast = 1}, nullptr, 1).means;
    };
    const auto of_taught = terms(taught), of_truth = terms(truth);
    for (const int k : {0, 1, 5}) {  // L1, 1 - SSIM, MSE
        EXPECT_NEAR(of_taught[std::size_t(k)], 0, 1e-5) << kLossNames[std::size_t(k)];
        EXPECT_GT(of_truth[std::size_t(k)], .1) << kLossNames[std::size_t(k)];
    }
    EXPECT_NEAR(of_truth[3], -1, 1e-6) << "no error: ln sigma alone";
    EXPECT_GT(of_taught[3], -1 + .5);
    EXPECT_EQ(of_truth[6], 1);
}

TEST(Losses, L1AsksForTheMedianAndL2ForTheMean) {
    // Three scenes that look alike to the sensor: two dark, one bright.
    const auto truth = torch::tensor({0.F, 0.F, 0.6F}).view({3, 1, 1}).expand({3, 32, 32});
    const auto slope_at = [&](float grey, const LossWeights& weights) {
        const auto mu = torch::full({}, grey).set_requires_grad(true);
        const auto s = torch::full({3, 32, 32}, -1.0);
        loss({mu.expand({3, 32, 32}), s, truth, torch::ones({3})}, weights, nullptr, 1)
            .total.backward();
        return mu.grad().item<double>();
    };
    EXPECT_NEAR(slope_at(.2F, only({.l2 = 1})), 0, 1e-6);
    EXPECT_GT(slope_at(.01F, only({.l1 = 1})), .3) << "darker still";
    EXPECT_LT(slope_at(-.01F, only({.l1 = 1})), -.3);
}

TEST(Losses, ImagesOfNoWeightCountNothing) {
    auto truth = torch::cat({test_image(32, 32, 4), test_image(32, 32, 5)});
    auto mu = truth.clone();
    mu[0] = 0;
    const auto s = torch::full_like(mu, -1);
    const auto cost = [&](std::vector<float> weight) {
        return loss({mu, s, truth, torch::tensor(weight)}, only({.l1 = 1, .ssim = 1}), nullptr, 1)
            .total.item<double>();
    };
    EXPECT_NEAR(cost({0, 1}), 0, 1e-5);
    EXPECT_GT(cost({1, 0}), 0.1);
}

TEST(Losses, FlickerIsSeenByTheTemporalTerm) {
    const auto still = test_image(32, 32, 6);
    const auto truth = torch::cat({still, still, still});
    const auto shift = torch::tensor({0.1F, -0.1F, 0.1F}).view({3, 1, 1});
    const auto s = torch::full_like(truth, -1);
    const auto temporal = [&](const torch::Tensor& mu) {
        return loss({mu, s, truth, torch::ones({3})}, {}, nullptr, 1).means[4];
    };
    EXPECT_NEAR(temporal(truth + 0.1), 0, 1e-6);
    EXPECT_NEAR(temporal(truth + shift), 0.2, 1e-5);
}

TEST(Losses, AChangeCountsAsMuchAsTheImageBeforeIt) {
    const auto still = test_image(32, 32, 6);
    const auto truth = torch::cat({still, still, still});
    const auto s = torch::full_like(truth, -1);
    auto mu = truth.clone();
    mu[0] += 0.5;  // of a state that had only just begun
    EXPECT_NEAR(loss({mu, s, truth, torch::tensor({0.F, 1.F, 1.F})}, {}, nullptr, 1).means[4], 0,
                1e-6);
    mu = truth.clone();
    mu[2] += 0.5;
    EXPECT_NEAR(loss({mu, s, truth, torch::tensor({0.F, 1.F, 0.F})}, {}, nullptr, 1).means[4], 0.5,
                1e-6);
}

TEST(Losses, SsimIsTheMeanOverTheSizesThatAreLargeEnough) {
    const auto halved = [](const torch::Tensor& x) { return torch::avg_pool2d(x, 2); };
    const auto a = test_image(70, 64, 1), b = 0.7 * a + 0.3 * test_image(70, 64, 2);
    const auto half_a = halved(a), half_b = halved(b);
    EXPECT_NEAR(multi_scale_ssim(a, b).item<double>(),
                (ssim(a, b).item<double>() + ssim(half_a, half_b).item<double>() +
                 ssim(halved(half_a), halved(half_b)).item<double>()) /
                    3,
                1e-6);
    EXPECT_NEAR(multi_scale_ssim(half_a, half_b).item<double>(),
                (ssim(half_a, half_b).item<double>() +
                 ssim(halved(half_a), halved(half_b)).item<double>()) /
                    2,
                1e-6)
        << "32 px";
}

TEST(Losses, LpipsHasTheAuthorsValues) {
    const fs::path npz = kPerceptual / "lpips_squeeze_v0.1.npz";
    if (!fs::exists(npz)) GTEST_SKIP() << "needs " << npz;
    const torch::NoGradGuard none;
    const Perceptual perceptual{npz, torch::kCPU};
    const auto read = [](const char* name) {
        const cv::Mat bgr = cv::imread((kPerceptual / name).string(), cv::IMREAD_COLOR);
        const auto bytes =
            torch::from_blob(bgr.data, {bgr.rows, bgr.cols, 3}, torch::kByte).clone();
        return bytes.to(torch::kFloat).flip(2).permute({2, 0, 1}).unsqueeze(0) / 255;
    };
    const auto reference = read("ex_ref.png");
    EXPECT_NEAR(perceptual.distance(read("ex_p0.png"), reference).item<double>(), .7110, 1e-3);
    EXPECT_NEAR(perceptual.distance(read("ex_p1.png"), reference).item<double>(), .1479, 1e-3);
    const auto grey = reference.mean(1), other = read("ex_p0.png").mean(1);
    const auto repeated = [](const torch::Tensor& x) {
        return x.unsqueeze(1).expand({-1, 3, -1, -1});
    };
    EXPECT_NEAR(perceptual.distance(grey, other).item<double>(),
                perceptual.distance(repeated(grey), repeated(other)).item<double>(), 1e-4);
}

}  // namespace
}  // namespace eventide
