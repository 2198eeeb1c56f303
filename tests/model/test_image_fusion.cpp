// Images of the camera beside its events: what is added to the model's frames, where and for how
// long.
#include "tests/model/image_fusion_test.h"

#include <gtest/gtest.h>

namespace eventide {
namespace {

using namespace test;

TEST_F(ImageFusionTest, WithoutImagesNothingIsChanged) {
    advance(50, 2);
    const Frame frame = shown(30);
    for (const float v : frame.intensity.values()) EXPECT_EQ(v, .4F);
    for (const float v : frame.sigma.values()) EXPECT_NEAR(v, .2F, 1e-6);
}

TEST_F(ImageFusionTest, OfAStillSceneTheImageIsHeldForAsLongAsNothingHappens) {
    advance(50);
    ASSERT_TRUE(correct(ramp(), 40));
    for (int i = 2; i < 1000; ++i) advance(50 * i);
    const Frame frame = shown(now_ms_);
    for (std::size_t i = 0; i < frame.intensity.values().size(); ++i) {
        ASSERT_NEAR(frame.intensity.values()[i], ramp().values()[i], 1e-4);
        ASSERT_NEAR(frame.sigma.values()[i], .02F, 1e-3) << "no surer than the image";
    }
}

TEST_F(ImageFusionTest, AnImageComesInOverItsWindowWithoutAJump) {
    advance(50);
    advance(100);
    ASSERT_TRUE(correct(constant(.8F), 100));
    EXPECT_NEAR(shown(50.001).intensity(9, 9), .4F, 1e-4);
    EXPECT_NEAR(shown(75).intensity(9, 9), .6F, 1e-4);
    EXPECT_NEAR(shown(100).intensity(9, 9), .8F, 1e-4);
    advance(150);
    EXPECT_NEAR(shown(100.001).intensity(9, 9), .8F, 1e-4);
    EXPECT_NEAR(shown(75).intensity(9, 9), .6F, 1e-4) << "of the window before, too";
    advance(200);
    EXPECT_NEAR(shown(75).intensity(9, 9), .6F, 1e-4) << "and of the one before that";
}

TEST_F(ImageFusionTest, FromItsTimeOnAnImageCountsWhole) {
    advance(50);
    advance(100);
    ASSERT_TRUE(correct(constant(.8F), 75));
    EXPECT_NEAR(shown(50.001).intensity(9, 9), .4F, 1e-3);
    EXPECT_NEAR(shown(62.5).intensity(9, 9), .6F, 1e-4);
    for (const double ms : {75., 90., 100.})
        EXPECT_NEAR(shown(ms).intensity(9, 9), .8F, 1e-4) << ms;
    advance(150);
    ASSERT_TRUE(correct(constant(.6F), 90)) << "late";
    EXPECT_NEAR(shown(100.001).intensity(9, 9), .8F, 1e-4) << "no jump, all the same";
    EXPECT_NEAR(shown(112.5).intensity(9, 9), .6F, 1e-4);
}

TEST_F(ImageFusionTest, AnImageFromBeforeTheFirstEventCorrectsTheFirstFrame) {
    advance(100);
    ASSERT_TRUE(correct(constant(.8F), 0));
    for (const double ms : {0., .001, 50., 100.})
        EXPECT_NEAR(shown(ms).intensity(9, 9), .8F, 1e-4) << ms;
    EXPECT_NEAR(shown(.001).sigma(9, 9), .02F, 1e-3);
    ASSERT_TRUE(correct(constant(.8F), 80)) << "another one in the same window";
    EXPECT_NEAR(shown(.001).intensity(9, 9), .8F, 1e-4) << "takes nothing back";
}

TEST_F(ImageFusionTest, OfImagesFromBeforeTheFirstEventTheLastCounts) {
    advance(100);
    ASSERT_TRUE(correct(constant(.6F), 0));
    ASSERT_TRUE(correct(constant(.8F), 0));
    EXPECT_NEAR(shown(.001).intensity(9, 9), .8F, 1e-4);
}

TEST_F(ImageFusionTest, TheFirstImageIsNotHeldUpByAnotherOneInItsWindow) {
    advance(100);
    ASSERT_TRUE(correct(constant(.8F), 10));
    ASSERT_TRUE(correct(constant(.8F), 90));
    EXPECT_NEAR(shown(5).intensity(9, 9), .6F, 1e-4) << "without a jump";
    for (const double ms : {10., 50., 100.})
        EXPECT_NEAR(shown(ms).intensity(9, 9), .8F, 1e-4) << ms;
    advance(200);
    ASSERT_TRUE(correct(constant(.4F), 110));
    EXPECT_NEAR(shown(112.5).intensity(9, 9), .6F, 1e-4) << "others come in over some time";
}

/// Of a stream whose first image came when windows had passed that nobody remembers.
TEST_F(ImageFusionTest, AnImageFromBeforeAWindowIsNotTakenForOneOfItsBegin) {
    fusion_.begin_within_stream();
    now_ms_ = 100;
    EXPECT_EQ(shown(95).intensity(9, 9), .4F) << "before the first window that is known";
    advance(120, .5F);
    EXPECT_EQ(shown(95).intensity(9, 9), .4F);
    ASSERT_TRUE(fusion_.correct(image_of(constant(.8F), at_ms(60)), grey(.4F, at_ms(100))));
    EXPECT_NEAR(shown(100.001).intensity(9, 9), .4F, 1e-3F) << "no jump";
    EXPECT_GT(shown(120).sigma(9, 9), .04F) << "events between may have moved it";
}

TEST_F(ImageFusionTest, OtherSizesAndPartsAreOfTheSameFrame) {
    advance(50);
    ASSERT_TRUE(correct(ramp(), 50));
    const RenderRequest larger{.width = 2 * kWidth, .height = 2 * kHeight};
    const Frame whole = shown(50, larger);
    for (int x = 0; x < 2 * kWidth; ++x) {
        const double on_sensor = double(x) * (kWidth - 1) / (2 * kWidth - 1);  // corners on corners
        EXPECT_NEAR(whole.intensity(9, x), .1 + .8 * (on_sensor + .5) / kWidth, 1e-3);
    }
    RenderRequest part = larger;
    part.region = {11, 7, 20, 9};
    const Frame cut = shown(50, part);
    for (int y = 0; y < 9; ++y)
        for (int x = 0; x < 20; ++x) ASSERT_EQ(cut.intensity(y, x), whole.intensity(y + 7, x + 11));
}

TEST_F(ImageFusionTest, APartShowsItsOwnRowsOfTheImage) {
    Array2<float> downwards = constant(0);
    for (int y = 0; y < kHeight; ++y)
        for (float& v : downwards.row(y)) v = .1F + .8F * float(y) / kHeight;
    advance(50);
    ASSERT_TRUE(correct(downwards, 50));
    RenderRequest request;
    const Frame whole = shown(50, request);
    request.region = {3, 5, 8, 6};
    const Frame part = shown(50, request);
    EXPECT_GT(whole.intensity(10, 4) - whole.intensity(5, 4), .1F);
    for (int y = 0; y < 6; ++y)
        for (int x = 0; x < 8; ++x) ASSERT_EQ(part.intensity(y, x), whole.intensity(y + 5, x + 3));
}

TEST_F(ImageFusionTest, ASaturatedImageSaysAtLeastSoBrightAndABlackOneAtMost) {
    // What is added to a model that shows `model`, when the image says `seen`.
    const auto added = [&](float model, float seen) {
        fusion_.reset();
        now_ms_ = 0;
        advance(50, 0, model);
        EXPECT_TRUE(fusion_.correct(image_of(constant(seen), at_ms(50)), grey(model, at_ms(50))));
        return shown(50, {}, model).intensity(5, 5) - model;
    };
    EXPECT_NEAR(added(1.2F, 1), 0, 1e-5F) << "1.2 may be true";
    EXPECT_NEAR(added(.4F, 1), .6F, 1e-3F) << ".4 can't";
    EXPECT_NEAR(added(-.1F, 0), 0, 1e-5F);
    EXPECT_NEAR(added(.4F, 0), -.4F, 1e-3F);
}

TEST_F(ImageFusionTest, WhatMovedSinceALateImageCountsAgainstIt) {
    const auto sigma_after = [&](double image_ms) {
        fusion_.reset();
        now_ms_ = 0;
        for (int i = 1; i <= 10; ++i) advance(10 * i, .3F);
        EXPECT_TRUE(correct(ramp(), image_ms));
        return shown(100).sigma(9, 9);
    };
    EXPECT_LT(sigma_after(100), .021F);
    EXPECT_GT(sigma_after(60), 1.5F * sigma_after(100));
    EXPECT_GT(sigma_after(20), sigma_after(60));
}

TEST_F(ImageFusionTest, AnImageThatIsBlurredByMotionIsTrustedLess) {
    for (int i = 1; i <= 10; ++i) advance(10 * i, .3F);
    ReferenceImage image = image_of(ramp(), at_ms(100));
    image.exposure_begin = at_ms(60);
    ASSERT_TRUE(fusion_.correct(image, grey(.4F, at_ms(100))));
    EXPECT_GT(shown(100).sigma(9, 9), .04F);
}

/// Recordings may say anything of it.
TEST_F(ImageFusionTest, AnExposureThatBeganBeforeAllTimeIsALongOne) {
    const auto sigma_of = [&](SensorTime exposure_begin) {
        fusion_.reset();
        now_ms_ = 0;
        for (int i = 1; i <= 10; ++i) advance(10 * i, .3F);
        ReferenceImage image = image_of(ramp(), at_ms(100));
        image.exposure_begin = exposure_begin;
        EXPECT_TRUE(fusion_.correct(image, grey(.4F, at_ms(100))));
        return shown(100).sigma(9, 9);
    };
    EXPECT_EQ(sigma_of(SensorTime::min()), sigma_of(at_ms(-5000)));
    EXPECT_EQ(sigma_of(SensorTime::max()), sigma_of(at_ms(100)));
}

TEST_F(ImageFusionTest, ImagesOfOtherTimesTellNothing) {
    EXPECT_FALSE(correct(ramp(), 0)) << "before the first window";
    advance(500);
    EXPECT_FALSE(correct(ramp(), 501));
    EXPECT_FALSE(correct(ramp(), 250));
    EXPECT_EQ(shown(500).intensity(3, 3), .4F);
}

TEST_F(ImageFusionTest, APartOfTheSensorCorrectsThatPart) {
    advance(50);
    ReferenceImage image = image_of(constant(.9F, 16, 16), at_ms(50));
    image.x0 = 28;  // reaches to the sensor's edge
    image.y0 = -4;  // and beyond
    ASSERT_TRUE(fusion_.correct(image, grey(.4F, at_ms(50))));
    const Frame frame = shown(50);
    EXPECT_NEAR(frame.intensity(4, 36), .9F, 1e-3);
    EXPECT_NEAR(frame.intensity(25, 5), .4F, 1e-3);
    EXPECT_GT(frame.sigma(25, 5), 2 * frame.sigma(4, 36));
}

}  // namespace
}  // namespace eventide
