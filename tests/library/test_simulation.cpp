// Scenes and measures of the library: what the program simulates, and what it would say of a frame.
#include "tests/library/library_test.h"
#include "tests/metrics/images.h"

#include <limits>
#include <vector>

namespace eventide::test {
namespace {

using Simulation = LibraryTest;

TEST_F(Simulation, EventsAndTruthsAreThoseOfTheProgram) {
    EventSimulation simulation{{.width = 64,
                                .height = 48,
                                .seconds = .4,
                                .images_per_second = 25,
                                .truths_per_second = 50}};
    std::vector<Event> events;
    std::vector<ReferenceImage> images;
    std::vector<TrueImage> all;
    Batch batch;
    for (std::vector<TrueImage> truths; simulation.read(batch, truths);) {
        events.insert(events.end(), batch.events.begin(), batch.events.end());
        images.insert(images.end(), batch.images.begin(), batch.images.end());
        for (TrueImage& truth : truths) all.push_back(std::move(truth));
    }
    EXPECT_EQ(events, events_of(recording()));
    EXPECT_EQ(images.size(), 11U);
    ASSERT_EQ(all.size(), 21U);
    EXPECT_EQ(to_us(all[1].t), 20'000);
    EXPECT_EQ(to_us(simulation.clock()), 400'000);
    // The camera's image is its truth, in 16 bits.
    EXPECT_NEAR(all.front().intensity(7, 9), images.front().pixels(7, 9) / 65535.F, 1e-4);
}

TEST_F(Simulation, WhatMakesNoSenseIsRefusedByName) {
    EXPECT_NE(error_of([] { EventSimulation{{.scene = "nowhere"}}; }).find("nowhere"),
              std::string::npos);
    EXPECT_TRUE(error_of([] { EventSimulation{{.height = 0}}; }).ends_with("px, found 0"));
    EXPECT_NE(error_of([] { EventSimulation{{.seconds = 1e13}}; }).find("seconds"),
              std::string::npos);
    error_of([] { EventSimulation{{.textures = "/nowhere"}}; }, ErrorKind::input);
}

TEST(Measures, SayWhatIsWrongWithAFrame) {
    Array2<float> truth(20, 30), shown(20, 30), sigma(20, 30);
    for (std::size_t i = 0; i < truth.values().size(); ++i) {
        truth.values()[i] = float(i % 7) / 7;
        shown.values()[i] = truth.values()[i] * .5F + .2F;
        sigma.values()[i] = i % 2 == 0 ? 1.F : 1e-6F;
    }
    const FrameMeasures alone = measure(shown, {}, truth);
    EXPECT_GT(alone.mse, .01);
    EXPECT_NEAR(alone.affine_mse, 0, 1e-9);
    EXPECT_NEAR(alone.affine_ssim, 1, 1e-4);
    EXPECT_LT(alone.ssim, alone.affine_ssim);
    EXPECT_FALSE(alone.picp80.has_value());
    EXPECT_NEAR(measure(shown, sigma, truth).picp80.value_or(0), .5, .01);
    const Array2<float> narrow(20, 31);
    EXPECT_EQ(error_of([&] { measure(shown, sigma, narrow); }),
              "truth: expected the size of intensity, 30x20, found 31x20");
    EXPECT_EQ(error_of([&] { measure(shown, narrow, truth); }),
              "sigma: expected the size of intensity, 30x20, found 31x20");
    sigma(3, 4) = -.5F;
    EXPECT_NE(error_of([&] { measure(shown, sigma, truth); }).find("sigma: expected 0 or more"),
              std::string::npos);
}

TEST(Measures, RefuseWhatIsNoNumber) {
    // Clipped, NaN would be black, and here as right as can be.
    const Array2<float> black(20, 30);
    Array2<float> broken = black;
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    for (const float number : {std::numeric_limits<float>::quiet_NaN(), kInfinity, -kInfinity}) {
        broken(3, 4) = number;
        const std::string words = ": expected finite numbers, found " + std::to_string(number);
        EXPECT_EQ(error_of([&] { measure(broken, {}, black); }), "intensity" + words);
        EXPECT_EQ(error_of([&] { measure(black, broken, black); }), "sigma" + words);
        EXPECT_EQ(error_of([&] { measure(black, {}, broken); }), "truth" + words);
    }
}

TEST(Measures, OfLpipsAreThoseOfItsWeights) {
    EXPECT_NE(
        error_of([] { PerceptualDistance{"/missing.npz"}; }, ErrorKind::input).find("/missing.npz"),
        std::string::npos);
    const auto weights = shared_data() / "perceptual/lpips_squeeze_v0.1.npz";
    if (!std::filesystem::exists(weights)) GTEST_SKIP() << "no LPIPS weights: " << weights;
    const PerceptualDistance lpips{weights};
    EXPECT_EQ(lpips.name(), "LPIPS-Squeeze");
    Array2<float> truth(40, 50), noisy(40, 50);
    for (std::size_t i = 0; i < truth.values().size(); ++i) {
        truth.values()[i] = float(i % 50) / 50;
        noisy.values()[i] = truth.values()[i] * (i % 3 == 0 ? .2F : 1.F);
    }
    const FrameMeasures same = measure(truth, {}, truth, &lpips);
    EXPECT_EQ(same.lpips, 0);
    EXPECT_EQ(measure(noisy, {}, truth, &lpips).lpips, lpips.between(noisy, truth));
    EXPECT_GT(lpips.between(noisy, truth), .05);
    EXPECT_EQ(measure(noisy, {}, truth).lpips, std::nullopt);
    EXPECT_NE(error_of([&] { lpips.between(truth, Array2<float>(40, 49)); }).find("50x40"),
              std::string::npos);
    // The network's layers make 0 of it, and a distance that looks like one.
    noisy(3, 4) = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(error_of([&] { lpips.between(noisy, truth); }),
              "LPIPS, first image: expected finite numbers, found nan");
    EXPECT_EQ(error_of([&] { lpips.between(truth, noisy); }),
              "LPIPS, second image: expected finite numbers, found nan");
}

}  // namespace
}  // namespace eventide::test
