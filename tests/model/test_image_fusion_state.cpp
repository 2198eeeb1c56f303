// How long an image is taken to hold, and what is left of it: numbers as docs/model.md has them,
// "Images of the camera", and beginnings.
#include "tests/model/image_fusion_test.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace eventide {
namespace {

using namespace test;

/// Sigma of a model whose own is .2, where n events per pixel count against an image that could be
/// trusted everywhere: 30 x 44 px have five bands.
double sigma_after(double n) {
    double left = 0;
    for (int k = 0; k < 5; ++k) left += (1 - std::exp(-4 * n / (1 << k))) / 5;
    return std::sqrt(left * .2 * .2 + (1 - left) * .02 * .02);
}

TEST_F(ImageFusionTest, EventsOfWhatWasFollowedCountATenth) {
    for (int i = 1; i <= 10; ++i) advance(20 * i, .6F);
    ASSERT_TRUE(correct(ramp(), 160)) << "two windows late";
    EXPECT_NEAR(shown(200).sigma(9, 9), sigma_after(.12), 1e-4);
    advance(220, .6F);
    EXPECT_NEAR(shown(220).sigma(9, 9), sigma_after(.18), 1e-4);
    advance(240, .6F);
    EXPECT_NEAR(shown(230).sigma(9, 9),
                std::sqrt((std::pow(sigma_after(.18), 2) + std::pow(sigma_after(.24), 2)) / 2),
                1e-4)
        << "halfway between two ends";
}

/// Of a stream whose first image came when windows had passed that nobody remembers.
TEST_F(ImageFusionTest, BeforeTheFirstWindowEventsCameAsOftenAsSince) {
    fusion_.begin_within_stream();
    now_ms_ = 100;
    advance(120, .6F);
    ASSERT_TRUE(correct(ramp(), 60));
    EXPECT_NEAR(shown(120).sigma(9, 9), sigma_after(.18), 1e-4);
    advance(140, .6F);
    EXPECT_NEAR(shown(140).sigma(9, 9), sigma_after(.24), 1e-4);
}

TEST_F(ImageFusionTest, WhatIsLeftOfAnImageFadesEvenlyThroughAWindow) {
    Array2<float> board = constant(.4F);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) board(y, x) += (x + y) % 2 == 0 ? .2F : -.2F;
    advance(20);
    ASSERT_TRUE(correct(board, 20));
    const auto detail = [this](double ms) { return shown(ms).intensity(10, 10) - .4F; };
    advance(40, .6F);
    const float at_begin = detail(20.001), at_end = detail(40);
    EXPECT_NEAR(at_begin, .2, 1e-3) << "as at the end of the window before";
    EXPECT_NEAR(at_end, .2 * std::exp(-2 * .06), 1e-3);
    EXPECT_NEAR(detail(30), (at_begin + at_end) / 2, 1e-4);
    advance(60, .6F);
    EXPECT_NEAR(detail(40.001), at_end, 1e-4);
    for (int ms = 80; ms <= 2000; ms += 20) advance(ms, .6F);
    advance(2020);
    ASSERT_TRUE(correct(board, 2010));
    EXPECT_NEAR(detail(2010), .2, 1e-3) << "of a new image nothing has faded";
}

TEST_F(ImageFusionTest, EventsOfAnExposureCountWhole) {
    for (int i = 1; i <= 10; ++i) advance(20 * i, .6F);
    ReferenceImage image = image_of(ramp(), at_ms(200));
    image.exposure_begin = at_ms(180);
    ASSERT_TRUE(fusion_.correct(image, grey(.4F, at_ms(200))));
    EXPECT_NEAR(shown(200).sigma(9, 9), sigma_after(.6), 1e-4);
}

/// Of an image so late that the model does not know any more what it showed.
TEST_F(ImageFusionTest, EventsFromBeforeWhatIsStillShownCountWhole) {
    for (int i = 1; i <= 10; ++i) advance(20 * i, .6F);
    ASSERT_TRUE(fusion_.correct(image_of(ramp(), at_ms(120)), grey(.4F, at_ms(160))));
    EXPECT_NEAR(shown(200).sigma(9, 9), sigma_after(1.2 + .12), 1e-4);
}

TEST_F(ImageFusionTest, EventsOfWhatCouldNotBeFollowedCountWhole) {
    const auto advance_unknown = [&](double end_ms) {
        fusion_.advance({at_ms(now_ms_), at_ms(end_ms)}, constant(.6F), nullptr);
        now_ms_ = end_ms;
    };
    for (int i = 1; i <= 10; ++i) advance_unknown(20 * i);
    ASSERT_TRUE(correct(ramp(), 180));
    const Frame frame = shown(200);
    EXPECT_NEAR(frame.sigma(9, 9), sigma_after(.6), 1e-4);
    EXPECT_NEAR(frame.intensity(9, 9), ramp()(9, 9), .1) << "against what was shown at its time";
    advance_unknown(220);
    EXPECT_NEAR(shown(220).sigma(9, 9), sigma_after(1.2), 1e-4);
}

/// Of a window whose end is one of four that are remembered.
TEST_F(ImageFusionTest, AnImageWithinAWindowIsNoneOfLaterWindows) {
    advance(20);
    advance(40);
    ASSERT_TRUE(correct(ramp(), 30));
    for (int ms = 60; ms <= 160; ms += 20) {
        advance(ms, .6F);
        const double before = shown(ms - 20 + .001).sigma(9, 9), after = shown(ms).sigma(9, 9);
        EXPECT_NEAR(shown(ms - 10).sigma(9, 9), std::sqrt((before * before + after * after) / 2),
                    1e-4)
            << ms;
    }
}

TEST_F(ImageFusionTest, AnImageOfTwoHundredMillisecondsAgoIsTheOldest) {
    for (int i = 1; i <= 30; ++i) advance(20 * i, .1F);
    EXPECT_FALSE(correct(ramp(), 399.999));
    EXPECT_TRUE(correct(ramp(), 400));
}

TEST_F(ImageFusionTest, OutsideOfAPartWhatWasThereBeforeStays) {
    ReferenceImage part = image_of(constant(.9F, 8, 8), at_ms(60));
    part.x0 = part.y0 = 4;
    advance(40);
    ASSERT_TRUE(correct(ramp(), 40));
    advance(60);
    ASSERT_TRUE(fusion_.correct(part, grey(.4F, at_ms(60))));
    EXPECT_NEAR(shown(60).intensity(25, 40), ramp()(25, 40), 1e-3);
    EXPECT_NEAR(shown(60).intensity(8, 8), .9, 1e-3);
}

TEST_F(ImageFusionTest, WhereNoImageHasBeenTheModelAloneCounts) {
    ReferenceImage part = image_of(constant(.9F, 8, 8), at_ms(40));
    part.x0 = part.y0 = 4;
    advance(40);
    ASSERT_TRUE(fusion_.correct(part, grey(.4F, at_ms(40))));
    advance(60, .01F, .5F);
    EXPECT_NEAR(shown(60, {}, .5F).intensity(25, 40), .5, .01);
}

TEST_F(ImageFusionTest, FramesThatDifferInOneNumberAreEachTheirOwn) {
    advance(50);
    ASSERT_TRUE(correct(ramp(), 50));
    const RenderRequest one{.width = 80, .height = 60, .region = {10, 7, 20, 9}};
    std::vector<RenderRequest> all(4, one);
    all[1].region.x = 30;
    all[2].width = 120;
    all[3].region.width = 35;
    for (const RenderRequest& request : all)
        for (const RenderRequest& other : all) {
            shown(50, other);
            const Frame frame = shown(50, request);
            for (const int x : {0, request.region.width - 1})
                EXPECT_NEAR(
                    frame.intensity(3, x),
                    .1 + .8 *
                             (double(request.region.x + x) * (kWidth - 1) / (request.width - 1) +
                              .5) /
                             kWidth,
                    1e-3);
        }
}

/// What was before leaves no trace.
TEST_F(ImageFusionTest, AfterAResetFramesAreThoseOfAFreshOne) {
    ReferenceImage part = image_of(constant(.9F, 8, 8), at_ms(30));
    part.x0 = part.y0 = 4;
    const auto begin = [&](ImageFusion& fusion) {
        std::vector<Frame> frames;
        const auto show = [&](double ms) {
            fusion.prepare({});
            fusion.apply({}, constant(.4F), frames.emplace_back(grey(.4F, at_ms(ms))));
        };
        fusion.advance({at_ms(0), at_ms(20)}, constant(.2F), nullptr);
        for (const double ms : {0., 10., 20.}) show(ms);
        const Frame at_end = grey(.4F, at_ms(40));
        fusion.advance({at_ms(20), at_ms(40)}, constant(.2F), &at_end);
        EXPECT_TRUE(fusion.correct(part, grey(.4F, at_ms(30))));
        for (const double ms : {15., 25., 40.}) show(ms);
        const Frame brighter = grey(.5F, at_ms(60));
        fusion.advance({at_ms(40), at_ms(60)}, constant(.2F), &brighter);
        show(60);
        fusion.advance({at_ms(60), at_ms(80)}, constant(.2F), nullptr);
        show(80);
        return frames;
    };
    ImageFusion fresh{kWidth, kHeight};
    const std::vector<Frame> expected = begin(fresh);
    for (const int windows : {1, 2, 3, 4, 9}) {
        for (int i = 1; i <= windows; ++i) advance(20 * i, .3F, .6F);
        correct(ramp(), now_ms_ - 5);
        fusion_.reset();
        now_ms_ = 0;
        const std::vector<Frame> found = begin(fusion_);
        fusion_.reset();
        for (std::size_t i = 0; i < found.size(); ++i) {
            EXPECT_EQ(found[i].intensity, expected[i].intensity) << i;
            EXPECT_EQ(found[i].sigma, expected[i].sigma) << i;
        }
    }
}

}  // namespace
}  // namespace eventide
