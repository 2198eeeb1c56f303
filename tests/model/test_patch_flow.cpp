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
