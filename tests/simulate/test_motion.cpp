// Motion, pauses and changes of light.
#include "src/simulate/scene/motion.h"
#include "src/simulate/scene/scene.h"

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
            // Points lie in the table's ranges; a cubic may swing beyond by some.
            EXPECT_LT(std::abs(pose.x), 2 * 2 * settings.displacement_max);
            EXPECT_LT(std::abs(pose.angle), 2 * settings.angle_max);
            EXPECT_GE(pose.scale_x, .1);
        }
    }
}

TEST(WanderMotion, KeepsItsSpeedOnAverage) {
    WanderSettings settings;
    settings.linear_probability = 1;
    double total = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        const auto motion = wander_motion(settings, 100, 50, {}, {}, Random{seed});
        motion->prepare(60);
        double way = 0;
        for (int i = 0; i < 60000; ++i) {
            const Pose a = motion->at(i * .001), b = motion->at((i + 1) * .001);
            way += std::hypot(b.x - a.x, b.y - a.y);
        }
        total += way / 60 / 40;
    }
    EXPECT_NEAR(total, 100, 4);
}

TEST(WanderMotion, StaysNearHome) {
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        const auto motion = wander_motion({}, 500, 10, {50, 50}, {0, 0, 100, 100}, Random{seed});
        motion->prepare(100);
        int away = 0;
        for (int i = 0; i < 1000; ++i) {
            const Pose p = motion->at(i * .1);
            away += p.x < -100 || p.x > 200 || p.y < -100 || p.y > 200;
        }
        EXPECT_LT(away, 100);
    }
}

TEST(WanderMotion, DoesNotDependOnHowItIsPreparedOrForgotten) {
    const auto once = wander_motion({}, 50, 20, {}, {}, Random{5});
    const auto bit_by_bit = wander_motion({}, 50, 20, {}, {}, Random{5});
    once->prepare(20);
    for (double t = 0; t < 20; t += .01) {
        bit_by_bit->prepare(t);
        EXPECT_EQ(once->at(t).x, bit_by_bit->at(t).x);
        bit_by_bit->forget(t);
    }
}

/// How far a motion at 100 px/s is from its start after 20 s, on average.
double way_from_start(const WanderSettings& settings) {
    double total = 0;
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        const auto motion = wander_motion(settings, 100, 50, {}, {}, Random{seed});
        motion->prepare(20);
        total += std::hypot(motion->at(20).x, motion->at(20).y) / 30;
    }
    return total;
}

TEST(WanderMotion, TremblesAboutOnePlaceWhereAskedFor) {
    WanderSettings settings;
    EXPECT_GT(way_from_start(settings), 500);
    settings.tremble = 1;
    EXPECT_LT(way_from_start(settings), 250);
}

/// Share of the time in which a motion at 100 px/s goes slower than `px_s`.
double share_below(double px_s, const WanderSettings& settings) {
    int slow = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const auto motion = wander_motion(settings, 100, 50, {}, {}, Random{seed});
        motion->prepare(60);
        for (int i = 0; i < 600; ++i) {
            const Pose a = motion->at(i * .1), b = motion->at(i * .1 + .01);
            slow += std::hypot(b.x - a.x, b.y - a.y) < .01 * px_s;
        }
    }
    return slow / 12000.;
}

TEST(WanderMotion, ChangesItsPaceWhereAskedFor) {
    WanderSettings settings;
    settings.linear_probability = 1;
    EXPECT_LT(share_below(10, settings), .01);
    settings.pace = {.02, 1};
    // Log-uniform: ln(.1 / .02) of ln(1 / .02) lies below a tenth of the full speed.
    EXPECT_NEAR(share_below(10, settings), std::log(5) / std::log(50), .12);
}

TEST(WanderMotion, MayBecomeFasterToo) {
    WanderSettings settings;
    settings.linear_probability = 1;
    EXPECT_GT(share_below(400, settings), .98);
    settings.pace = {1, 16};  // a half of the logarithms lie below 4
    EXPECT_NEAR(share_below(400, settings), .5, .12);
}

TEST(PauseClock, PausesWithTheProbabilitiesAskedFor) {
    PauseClock clock{.05, .9, .05, Random{2}};
    clock.prepare(5000);
    int paused = 0, starts = 0, moving = 0;
    bool last = false;
    for (int k = 0; k < 100000; ++k) {
        const bool still = clock.at((k + .75) * .05) == clock.at((k + .25) * .05);
        paused += still;
        starts += still && !last;
        moving += !last;
        last = still;
    }
    EXPECT_NEAR(double(starts) / moving, .05, .003);
    EXPECT_NEAR(double(paused) / starts, 10, .5);  // 1 / (1 - .9) steps
}

TEST(PauseClock, NeverRunsBackwardsOrFasterThanTime) {
    PauseClock clock{.2, .5, .03, Random{3}};
    clock.prepare(100);
    for (double t = 0; t < 99; t += .007) {
        const double way = clock.at(t + .007) - clock.at(t);
        EXPECT_GE(way, 0);
        EXPECT_LE(way, .007 + 1e-12);
    }
}

TEST(LightChanges, StaysInItsDepth) {
    LightChanges light{.7, .1, Random{4}};
    light.prepare(100);
    double low = 0, high = -1;
    for (double t = 0; t < 99; t += .01) {
        low = std::min(low, light.log_gain(t));
        high = std::max(high, light.log_gain(t));
    }
    EXPECT_NEAR(low, -.7, .02);
    EXPECT_NEAR(high, 0, .02);
    EXPECT_LE(high, 0);
}

TEST(LightChanges, StaysAsItIsInHalfOfItsSteps) {
    LightChanges light{.7, .1, Random{4}};
    light.prepare(201);
    int still = 0;
    for (int k = 0; k < 2000; ++k)
        still += light.log_gain((k + .25) * .1) == light.log_gain((k + .75) * .1);
    EXPECT_NEAR(still / 2000., .5, .05);
}

TEST(Flicker, HasItsFrequencyAndDepth) {
    const Flicker flicker{.depth = .4, .frequency_hz = 100, .phase = 0};
    EXPECT_NEAR(flicker.at(.01), 1.4, 1e-9);
    EXPECT_NEAR(flicker.at(.005), .6, 1e-9);
    EXPECT_EQ(Flicker{}.at(.123), 1);
}

}  // namespace
}  // namespace eventide
