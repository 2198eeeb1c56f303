// Motion as in the thesis: through control points, there and back.
#include "src/simulate/scene/motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace eventide {
namespace {

TEST(ControlCurve, PassesThroughItsPointsStraightOrCurved) {
    Random random{1};
    for (int n = 2; n <= 12; ++n)
        for (const bool cubic : {false, true}) {
            std::vector<double> values(static_cast<std::size_t>(n));
            for (double& v : values) v = random.uniform();
            const ControlCurve curve{values, cubic};
            for (int k = 0; k < n; ++k)
                EXPECT_NEAR(curve.at(double(k) / (n - 1)), values[std::size_t(k)], 1e-9);
        }
}

TEST(ControlCurve, CubicReproducesACubicExactly) {
    // Not-a-knot is the end condition under which a spline gives back any one polynomial.
    const auto polynomial = [](double x) { return 1 - 2 * x + 5 * x * x - 4 * x * x * x; };
    for (const int n : {4, 5, 6, 9, 15}) {
        std::vector<double> values;
        for (int k = 0; k < n; ++k) values.push_back(polynomial(double(k) / (n - 1)));
        const ControlCurve curve{values, true};
        for (double x = 0; x <= 1; x += .01) EXPECT_NEAR(curve.at(x), polynomial(x), 1e-9);
    }
}

TEST(ControlCurve, ThroughThreePointsIsAParabola) {
    const ControlCurve curve{{1, 2, 7}, true};  // 1 - 2 x + 8 x^2
    for (double x = 0; x <= 1; x += .05) EXPECT_NEAR(curve.at(x), 1 - 2 * x + 8 * x * x, 1e-9);
}

TEST(ThesisMotion, BeginsAtRestInItsRangesAndComesBack) {
    const ThesisMotionSettings settings;
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        const auto motion = thesis_motion(settings, Random{seed});
        const Pose first = motion->at(0);
        EXPECT_EQ(first.x, 0);
        EXPECT_EQ(first.angle, 0);
        EXPECT_EQ(first.scale_x, 1);
        for (double t = 0; t < settings.duration_s; t += .1) {
            const Pose pose = motion->at(t), back = motion->at(2 * settings.duration_s - t);
            EXPECT_NEAR(pose.x, back.x, 1e-9);
            EXPECT_NEAR(pose.x, motion->at(6 * settings.duration_s + t).x, 1e-9) << "and again";
            // Points lie in the table's ranges; a cubic may swing beyond by some.
            EXPECT_LT(std::abs(pose.x), 2 * 2 * settings.displacement_max);
            EXPECT_LT(std::abs(pose.angle), 2 * settings.angle_max);
        }
    }
}

TEST(ThesisMotion, NeverTurnsTheImageOverWhereACubicSwingsBeyondItsPoints) {
    const ThesisMotionSettings settings{.scale_max = 1, .linear_probability = 0};
    double smallest = 1;
    for (std::uint64_t seed = 0; seed < 400; ++seed) {
        const auto motion = thesis_motion(settings, Random{seed});
        for (double t = 0; t < settings.duration_s; t += .05)
            smallest = std::min({smallest, motion->at(t).scale_x, motion->at(t).scale_y});
    }
    EXPECT_EQ(smallest, .1);
}

/// The thesis' s and r: each scene uses a share of the ranges of scale and angle.
TEST(ThesisMotion, ScalesAndTurnsByAShareOfTheirRangesThatIsDrawnForEachScene) {
    const ThesisMotionSettings settings{.control_points_max = 2, .linear_probability = 1};
    double angle = 0, scale = 0, x = 0;
    constexpr int kScenes = 2000;
    for (std::uint64_t seed = 0; seed < kScenes; ++seed) {
        const Pose last = thesis_motion(settings, Random{seed})->at(settings.duration_s);
        angle += std::abs(last.angle) / kScenes;
        scale += std::abs(last.scale_x - 1) / kScenes;
        x += std::abs(last.x) / kScenes;
    }
    // Two points of a range are a third of it apart on average; the share is a half.
    EXPECT_NEAR(angle, settings.angle_max / 6, .02);
    EXPECT_NEAR(scale, settings.scale_max / 6, .01);
    EXPECT_NEAR(x, 2 * settings.displacement_max / 3, .02) << "all of it";
}

/// In how many of 400 steps the x of a motion changes its speed.
int bends(const ThesisMotionSettings& settings, std::uint64_t seed) {
    const auto motion = thesis_motion(settings, Random{seed});
    int found = 0;
    for (int i = 1; i < 400; ++i) {
        const auto x = [&](int k) { return motion->at(k * settings.duration_s / 400).x; };
        found += std::abs(x(i - 1) - 2 * x(i) + x(i + 1)) > 1e-9;
    }
    return found;
}

TEST(ThesisMotion, GoesStraightBetweenAsManyPointsAsDrawnOrCurves) {
    ThesisMotionSettings settings{.linear_probability = 1};
    int fewest = 400, most = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        fewest = std::min(fewest, bends(settings, seed));
        most = std::max(most, bends(settings, seed));
    }
    EXPECT_EQ(fewest, 0) << "2 points: straight from the first to the last";
    EXPECT_GE(most, 8) << "10 points, 8 of them between the ends ...";
    EXPECT_LE(most, 16) << "... and a bend may lie between two steps";
    settings.linear_probability = 0;
    int curved = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) curved += bends(settings, seed) > 390;
    EXPECT_GT(curved, 45) << "all but the few of 2 points";
}

TEST(ThesisMotion, TransformsByScaleDisplacementAndRotation) {
    const double a = .4, sx = 1.6, sy = .8, dx = .3, dy = -.2;
    const Affine A = thesis_transform({.x = dx, .y = dy, .angle = a, .scale_x = sx, .scale_y = sy});
    for (const Point p : {Point{0, 0}, Point{1, 0}, Point{0, 1}}) {
        // R, then D, then S: the matrices of equations 3.7, 3.6 and 3.5.
        const Point turned{std::cos(a) * p.x + std::sin(a) * p.y,
                           -std::sin(a) * p.x + std::cos(a) * p.y};
        EXPECT_NEAR(A(p).x, (turned.x - dx) / sx, 1e-12);
        EXPECT_NEAR(A(p).y, (turned.y - dy) / sy, 1e-12);
    }
}

TEST(ThesisMotion, ShowsThingsWhereTheMotionTookThem) {
    const auto shown_at = [](const Pose& pose, Point in_image) {
        return thesis_transform(pose).inverse()(in_image);
    };
    EXPECT_NEAR(shown_at({.x = 1}, {0, 0}).x, 1, 1e-12) << "the middle at the right edge";
    EXPECT_NEAR(shown_at({.y = .5}, {0, 0}).y, .5, 1e-12) << "below the middle";
    EXPECT_NEAR(shown_at({.scale_x = 2}, {.25, 0}).x, .5, 1e-12) << "twice as wide";
    EXPECT_NEAR(shown_at({.angle = std::numbers::pi / 2}, {.5, 0}).y, .5, 1e-12)
        << "what was right of the middle is below it";
}

}  // namespace
}  // namespace eventide
