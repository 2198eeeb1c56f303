// Images that follow a scene that moves.
#include "src/model/render/image_fusion.h"
#include "tests/model/fusion_images.h"

#include <gtest/gtest.h>

#include <cmath>

namespace eventide {
namespace {

using namespace test;

/// A scene of soft blobs that moves to the right, or down, of which the model shows a faint copy.
class MovingScene : public testing::Test {
protected:
    static constexpr int kSide = 96;
    static constexpr double kSpeed = .1;  // px per ms

    Array2<float> scene(double ms, float contrast = 1) const {
        Array2<float> map(kSide, kSide);
        for (int v = 0; v < kSide; ++v)
            for (int i = 0; i < kSide; ++i) {
                const double u = i - kSpeed * ms;
                const double wave = std::sin(.31 * u + .11 * v) * std::cos(.07 * u - .23 * v) +
                                    .5 * std::sin(.13 * u + .4 * v);
                (moves_down_ ? map(i, v) : map(v, i)) = float(.5 + contrast * .25 * wave);
            }
        return map;
    }
    Frame faint(double ms) const {
        Frame frame;
        frame.t = at_ms(ms);
        frame.intensity = scene(ms, .4F);
        frame.sigma = constant(.2F, kSide, kSide);
        return frame;
    }
    void advance(double end_ms, bool known = true) {
        const Frame at_end = faint(end_ms);
        fusion_.advance({at_ms(now_ms_), at_ms(end_ms)}, constant(.5F, kSide, kSide),
                        known ? &at_end : nullptr);
        now_ms_ = end_ms;
    }
    /// Root of the mean square, of what lies 12 px from the edges.
    static double error(const Array2<float>& shown, const Array2<float>& truth) {
        double sum = 0;
        for (int y = 12; y < kSide - 12; ++y)
            for (int x = 12; x < kSide - 12; ++x)
                sum += std::pow(double(shown(y, x)) - double(truth(y, x)), 2);
        return std::sqrt(sum / ((kSide - 24) * (kSide - 24)));
    }
    double error_at(double ms) {
        Frame frame = faint(ms);
        fusion_.prepare({});
        fusion_.apply({}, frame.intensity, frame);
        return error(frame.intensity, scene(ms));
    }
    double error_alone(double ms) const { return error(faint(ms).intensity, scene(ms)); }

    ImageFusion fusion_{kSide, kSide};
    double now_ms_ = 0;
    bool moves_down_ = false;
};

TEST_F(MovingScene, TheImageMovesWithTheScene) {
    advance(20);
    ASSERT_TRUE(fusion_.correct(image_of(scene(20), at_ms(20)), faint(20)));
    EXPECT_LT(error_at(20), .002);
    for (int ms = 40; ms <= 120; ms += 20) advance(ms);  // 10 px
    EXPECT_LT(error_at(120), .25 * error_alone(120));
}

TEST_F(MovingScene, BetweenTheEndsOfWindowsToo) {
    for (const bool down : {false, true}) {
        moves_down_ = down;
        fusion_.reset();
        now_ms_ = 0;
        advance(20);
        ASSERT_TRUE(fusion_.correct(image_of(scene(20), at_ms(20)), faint(20)));
        advance(80);  // 6 px in one window
        const double at_end = error_at(80);
        EXPECT_LT(at_end, .2 * error_alone(80)) << down;
        for (const int ms : {30, 40, 50, 60, 70})
            EXPECT_LT(error_at(ms), 1.5 * at_end) << ms << ' ' << down;
    }
}

TEST_F(MovingScene, AndInWindowsThatOthersFollowedMeanwhile) {
    advance(20);
    ASSERT_TRUE(fusion_.correct(image_of(scene(20), at_ms(20)), faint(20)));
    advance(80);
    advance(120);
    for (const int ms : {35, 50, 65}) EXPECT_LT(error_at(ms), .35 * error_alone(ms)) << ms;
    ASSERT_TRUE(fusion_.correct(image_of(scene(110), at_ms(110)), faint(110)));
    for (const int ms : {85, 90, 95}) EXPECT_LT(error_at(ms), .35 * error_alone(ms)) << ms;
    advance(160);
    for (const int ms : {85, 90, 95}) EXPECT_LT(error_at(ms), .35 * error_alone(ms)) << ms;
}

TEST_F(MovingScene, NotWhereItIsUnknownWhatTheModelShows) {
    advance(20);
    ASSERT_TRUE(fusion_.correct(image_of(scene(20), at_ms(20)), faint(20)));
    advance(120, false);
    EXPECT_GT(error_at(120), .6 * error_alone(120)) << "the detector detects";
    EXPECT_LT(error_at(120), 1.5 * error_alone(120)) << "what moved unfollowed is forgotten";
}

TEST_F(MovingScene, AnImageTakenWithinAWindowIsFollowedToItsEnd) {
    advance(20);
    advance(80);
    ASSERT_TRUE(fusion_.correct(image_of(scene(40), at_ms(40)), faint(40)));
    EXPECT_LT(error_at(80), .25 * error_alone(80));
}

TEST_F(MovingScene, AFirstImageTakenWithinAWindowCountsFromItsTimeOn) {
    for (const bool windows_before : {false, true}) {
        fusion_.reset();
        now_ms_ = 0;
        if (windows_before) advance(20);
        advance(80);
        ASSERT_TRUE(fusion_.correct(image_of(scene(40), at_ms(40)), faint(40)));
        for (const int ms : {40, 50, 60, 70, 80})
            EXPECT_LT(error_at(ms), .25 * error_alone(ms)) << ms;
        advance(120);
        for (const int ms : {50, 60, 70}) EXPECT_LT(error_at(ms), .35 * error_alone(ms)) << ms;
    }
}

TEST_F(MovingScene, AtItsOwnTimeAnImageIsShownHoweverThingsMovedBefore) {
    advance(20);
    ASSERT_TRUE(fusion_.correct(image_of(scene(20), at_ms(20)), faint(20)));
    // 6 px until 80, where the scene stops.
    const Frame at_end = faint(80);
    fusion_.advance({at_ms(20), at_ms(140)}, constant(.5F, kSide, kSide), &at_end);
    ASSERT_TRUE(fusion_.correct(image_of(scene(80), at_ms(80)), faint(80)));
    EXPECT_LT(error_at(80), .1 * error_alone(80));
}

/// The motion since then is too little to be measured.
TEST_F(MovingScene, AnImageJustBeforeAWindowsEndLeavesItsMotionAsItWas) {
    advance(20);
    ASSERT_TRUE(fusion_.correct(image_of(scene(20), at_ms(20)), faint(20)));
    advance(80);
    ASSERT_TRUE(fusion_.correct(image_of(scene(79), at_ms(79)), faint(79)));
    for (const int ms : {50, 60, 70, 79}) EXPECT_LT(error_at(ms), .1 * error_alone(ms)) << ms;
}

TEST_F(MovingScene, WhatWasOutsideOfTheSensorIsNotTakenForItsEdge) {
    advance(20);
    ASSERT_TRUE(fusion_.correct(image_of(scene(20), at_ms(20)), faint(20)));
    for (int ms = 40; ms <= 120; ms += 20) advance(ms);  // 10 px to the right
    const Frame alone = faint(120);
    Frame frame = alone;
    fusion_.prepare({});
    fusion_.apply({}, alone.intensity, frame);
    const Array2<float> truth = scene(120);
    double squares = 0, squares_alone = 0;
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < 7; ++x) {
            squares += std::pow(frame.intensity(y, x) - truth(y, x), 2);
            squares_alone += std::pow(alone.intensity(y, x) - truth(y, x), 2);
        }
    EXPECT_LT(squares, 1.5 * squares_alone) << "coarse structure around goes on";
}

TEST_F(MovingScene, TheFirstImageIsFollowedThroughItsWindow) {
    advance(80);
    ASSERT_TRUE(fusion_.correct(image_of(scene(0), at_ms(0)), faint(0)));
    fusion_.reset();  // what was another stream's is forgotten
    now_ms_ = 0;
    advance(60);  // 6 px
    ASSERT_TRUE(fusion_.correct(image_of(scene(0), at_ms(0)), faint(0)));
    for (const int ms : {1, 15, 30, 45, 60}) EXPECT_LT(error_at(ms), .3 * error_alone(ms)) << ms;
    advance(80);
    for (const int ms : {1, 15, 30, 45}) EXPECT_LT(error_at(ms), .35 * error_alone(ms)) << ms;
}

TEST_F(MovingScene, WhatAnotherSceneLookedLikeIsForgotten) {
    advance(20);
    // Turned by a quarter; from now on the model sees the scene as it is everywhere else here.
    const auto turned = [](const Array2<float>& map) {
        Array2<float> other(kSide, kSide);
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x) other(y, x) = map(x, y);
        return other;
    };
    Frame before = faint(20);
    before.intensity = turned(before.intensity);
    ASSERT_TRUE(fusion_.correct(image_of(turned(scene(20)), at_ms(20)), before));
    for (int i = 0; i < 40; ++i) advance(now_ms_ + 20);
    EXPECT_LT(error_at(now_ms_), 1.3 * error_alone(now_ms_));
}

}  // namespace
}  // namespace eventide
