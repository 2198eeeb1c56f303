// Optical flow between two frames.
#include "src/model/render/patch_flow.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

namespace eventide {
namespace {

/// Waves of 32 directions and lengths of 8 to 80 px, the longer the higher, at (x - dx, y - dy).
Array2<float> texture(int width, int height, double dx = 0, double dy = 0) {
    std::mt19937 random{3};
    std::uniform_real_distribution<double> uniform;
    Array2<float> map(height, width);
    std::ranges::fill(map.values(), .5F);
    for (int wave = 0; wave < 32; ++wave) {
        const double length = 8 * std::pow(10, uniform(random)), angle = 6.283 * uniform(random);
        const double u = 6.283 / length * std::cos(angle), v = 6.283 / length * std::sin(angle);
        const double begin = 6.283 * uniform(random);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                map(y, x) += float(.001 * length * std::cos(u * (x - dx) + v * (y - dy) + begin));
    }
    return map;
}

/// Events per pixel.
Array2<float> events(int width, int height, float each = 20) {
    Array2<float> map(height, width);
    std::ranges::fill(map.values(), each);
    return map;
}

Array2<float> noisy(Array2<float> map, float deviation, std::uint32_t seed) {
    std::mt19937 random{seed};
    std::normal_distribution<float> noise{0, deviation};
    for (float& v : map.values()) v += noise(random);
    return map;
}

/// The largest difference from the true motion, px, away from the edges.
double largest_error(const MotionField& motion, double dx, double dy, int margin) {
    double largest = 0;
    for (int y = margin; y < motion.dx.height() - margin; ++y)
        for (int x = margin; x < motion.dx.width() - margin; ++x)
            largest = std::max(
                largest, std::hypot(double(motion.dx(y, x)) - dx, double(motion.dy(y, x)) - dy));
    return largest;
}

TEST(PatchFlow, FindsWhereThingsWere) {
    constexpr int kWidth = 160, kHeight = 120;
    PatchFlow flow{kWidth, kHeight};
    for (const auto& [dx, dy] : {std::pair{.3, -.2}, {1., 0.}, {-2.5, 3.}, {7., -4.}, {11., 6.}}) {
        MotionField motion{kWidth, kHeight};
        // What was moved by (dx, dy) was that much further back.
        flow.find(texture(kWidth, kHeight, dx, dy), texture(kWidth, kHeight),
                  events(kWidth, kHeight), motion);
        EXPECT_LT(largest_error(motion, -dx, -dy, 12), .5) << dx << ' ' << dy;
        EXPECT_LT(flow.mismatch()(30, 40), .02F);
    }
}

TEST(PatchFlow, GoesOnFromTheMotionItIsGiven) {
    constexpr int kWidth = 160, kHeight = 120;
    PatchFlow flow{kWidth, kHeight};
    MotionField motion{kWidth, kHeight};
    for (double dx = 0; dx <= 36; dx += 6)
        flow.find(texture(kWidth, kHeight, dx), texture(kWidth, kHeight), events(kWidth, kHeight),
                  motion);
    EXPECT_LT(largest_error(motion, -36, 0, 24), 1);
}

TEST(PatchFlow, TheSameFrameHasNotMoved) {
    PatchFlow flow{90, 70};
    MotionField motion{90, 70};
    const Array2<float> frame = texture(90, 70);
    flow.find(frame, frame, events(90, 70), motion);
    for (const float d : motion.dx.values()) ASSERT_EQ(d, 0);
    for (const float d : motion.dy.values()) ASSERT_EQ(d, 0);
    for (const float d : flow.mismatch().values()) ASSERT_EQ(d, 0);
}

TEST(PatchFlow, BrightnessIsNoMotion) {
    PatchFlow flow{120, 90};
    MotionField motion{120, 90};
    Array2<float> brighter = texture(120, 90);
    for (float& v : brighter.values()) v += .07F;
    flow.find(brighter, texture(120, 90), events(120, 90), motion);
    EXPECT_LT(largest_error(motion, 0, 0, 0), .05);
    EXPECT_NEAR(flow.mismatch()(20, 20), .07F, 1e-3);
}

TEST(PatchFlow, NoiseDoesNotMovePlainSurfaces) {
    PatchFlow flow{120, 90};
    MotionField motion{120, 90};
    const Array2<float> plain = events(120, 90, .5F);
    flow.find(noisy(plain, .01F, 5), noisy(plain, .01F, 6), events(120, 90, .3F), motion);
    EXPECT_EQ(largest_error(motion, 0, 0, 0), 0);
    flow.find(noisy(plain, .01F, 5), noisy(plain, .01F, 6), events(120, 90, 50), motion);
    EXPECT_LT(largest_error(motion, 0, 0, 0), 2) << "a px of half size";
}

TEST(PatchFlow, WithoutEventsNothingMovesAndWithFewOnlyWhatFitsMuchBetter) {
    PatchFlow flow{120, 90};
    const Array2<float> then = texture(120, 90), flicker = noisy(then, .05F, 7);
    const Array2<float> moved = texture(120, 90, 2, 1);
    const auto error = [&](const Array2<float>& now, float each, double dx, double dy) {
        MotionField motion{120, 90};
        flow.find(now, then, events(120, 90, each), motion);
        return largest_error(motion, dx, dy, 12);
    };
    EXPECT_EQ(error(moved, 0, 0, 0), 0);
    EXPECT_EQ(error(flicker, .3F, 0, 0), 0);
    EXPECT_GT(error(flicker, 1e6F, 0, 0), 0) << "the detector detects";
    EXPECT_LT(error(moved, .3F, -2, -1), .5);
}

/// How far on average from the motion of each half, px, edges included.
double mean_error(const MotionField& motion, const FlowVector& left, const FlowVector& right) {
    double sum = 0;
    const int width = motion.dx.width();
    for (int y = 0; y < motion.dx.height(); ++y)
        for (int x = 0; x < width; ++x) {
            const FlowVector& truth = x < width / 2 ? left : right;
            sum += std::hypot(double(motion.dx(y, x) - truth.x), double(motion.dy(y, x) - truth.y));
        }
    return sum / double(motion.dx.values().size());
}

/// Two things that move each its own way, behind each other at their border, seen with noise.
TEST(PatchFlow, FindsTwoMotionsBesideEachOther) {
    constexpr int kWidth = 158, kHeight = 122;
    PatchFlow flow{kWidth, kHeight};
    const auto halves = [](double scale) {
        Array2<float> map = texture(kWidth, kHeight, 3 * scale, -2 * scale);
        const Array2<float> right = texture(kWidth, kHeight, -4 * scale, 1 * scale);
        for (int y = 0; y < kHeight; ++y)
            std::ranges::copy(right.row(y).last(kWidth / 2), map.row(y).last(kWidth / 2).begin());
        return map;
    };
    for (const auto& [scale, most] : {std::pair{1.F, .48}, {2.F, .95}, {4.F, 2.2}}) {
        MotionField motion{kWidth, kHeight};
        flow.find(noisy(halves(scale), .02F, 1), noisy(halves(0), .02F, 2),
                  events(kWidth, kHeight, 5), motion);
        EXPECT_LT(mean_error(motion, {-3 * scale, 2 * scale}, {4 * scale, -scale}), most) << scale;
    }
}

/// Patches at its edge lie on the surface, which tells nothing, and on what moves.
TEST(PatchFlow, WhatHasTextureOutweighsThePlainSurfaceItMovesOver) {
    constexpr int kWidth = 160, kHeight = 120, kRadius = 14;
    constexpr double kX = 80, kY = 60, kDx = 6, kDy = 4;
    const auto distance = [](int x, int y, double dx, double dy) {
        return std::hypot(x - kX - dx, y - kY - dy);
    };
    const auto disc = [&](double dx, double dy) {
        Array2<float> map = events(kWidth, kHeight, .5F);
        const Array2<float> inside = texture(kWidth, kHeight, dx, dy);
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x)
                if (distance(x, y, dx, dy) < kRadius) map(y, x) = inside(y, x);
        return map;
    };
    PatchFlow flow{kWidth, kHeight};
    MotionField motion{kWidth, kHeight};
    flow.find(disc(kDx, kDy), disc(0, 0), events(kWidth, kHeight), motion);
    double sum = 0;
    int pixels = 0;
    for (int y = 0; y < motion.dx.height(); ++y)
        for (int x = 0; x < motion.dx.width(); ++x) {
            if (distance(2 * x, 2 * y, kDx, kDy) >= kRadius - 2) continue;
            sum += std::hypot(motion.dx(y, x) + kDx, motion.dy(y, x) + kDy);
            ++pixels;
        }
    EXPECT_LT(sum / pixels, .25);
}

TEST(PatchFlow, FindsHowFarThingsWereOverWideDistances) {
    constexpr int kWidth = 158, kHeight = 122;
    PatchFlow flow{kWidth, kHeight};
    for (const auto& [dx, most] : {std::pair{14.F, .28}, {24.F, .63}, {32.F, 2.4}}) {
        MotionField motion{kWidth, kHeight};
        flow.find(texture(kWidth, kHeight, dx), texture(kWidth, kHeight), events(kWidth, kHeight),
                  motion);
        EXPECT_LT(mean_error(motion, {-dx, 0}, {-dx, 0}), most) << dx;
    }
}

TEST(PatchFlow, BeginsAtTheMotionItIsGiven) {
    constexpr int kWidth = 158, kHeight = 122;
    PatchFlow flow{kWidth, kHeight};
    for (const auto& [dx, most] : {std::pair{40.F, 4.3}, {50.F, 4.8}}) {
        MotionField motion{kWidth, kHeight};
        std::ranges::fill(motion.dx.values(), -dx);
        flow.find(texture(kWidth, kHeight, dx), texture(kWidth, kHeight), events(kWidth, kHeight),
                  motion);
        EXPECT_LT(mean_error(motion, {-dx, 0}, {-dx, 0}), most) << dx << ", edges included";
    }
}

TEST(PatchFlow, WhatIsBrighterThanWhiteOrDarkerThanBlackLooksAlike) {
    constexpr int kWidth = 120, kHeight = 90;
    PatchFlow flow{kWidth, kHeight};
    Array2<float> now = texture(kWidth, kHeight, 2, 1), then = texture(kWidth, kHeight);
    const auto blow_up = [](Array2<float>& map, float by) {
        for (float& v : map.values())
            v = v > .6F ? 1 + by * (v - .6F) : v < .4F ? by * (v - .4F) : v;
    };
    blow_up(now, 9);
    blow_up(then, 1);
    MotionField motion{kWidth, kHeight};
    flow.find(now, then, events(kWidth, kHeight), motion);
    EXPECT_LT(mean_error(motion, {-2, -1}, {-2, -1}), .05);
    EXPECT_LT(*std::ranges::max_element(flow.mismatch().values()), .15F);
}

TEST(PatchFlow, MismatchIsAMean) {
    PatchFlow flow{120, 90};
    MotionField motion{120, 90};
    const Array2<float> plain = events(120, 90, .5F);
    flow.find(noisy(plain, .1F, 3), plain, events(120, 90, 0), motion);
    EXPECT_LT(*std::ranges::max_element(flow.mismatch().values()), .09F);
    EXPECT_GT(*std::ranges::min_element(flow.mismatch().values()), .005F);
}

TEST(PatchFlow, FramesOfAnySizeAndAnyNumbersGiveFiniteMotion) {
    for (const auto& [width, height] :
         {std::pair{1, 1}, {3, 200}, {15, 15}, {16, 16}, {17, 33}, {64, 7}}) {
        PatchFlow flow{width, height};
        MotionField motion{width, height};
        Array2<float> wild(height, width);
        std::mt19937 random{1};
        for (int turn = 0; turn < 20; ++turn) {
            for (float& v : wild.values()) v = float(int(random() % 7)) * 1e8F - 3e8F;
            flow.find(wild, texture(width, height), events(width, height), motion);
        }
        for (const Array2<float>* map : {&motion.dx, &motion.dy})
            for (const float d : map->values())
                ASSERT_TRUE(std::isfinite(d)) << width << 'x' << height;
    }
}

}  // namespace
}  // namespace eventide
