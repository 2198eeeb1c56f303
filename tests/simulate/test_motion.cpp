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

TEST(WanderMotion, RunsSmoothlyThroughTheEndsOfItsLegs) {
    WanderSettings settings;
    settings.linear_probability = 0;
    settings.leg_s = {.1, .1};
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const auto motion = wander_motion(settings, 100, 50, {}, {}, Random{seed});
        motion->prepare(3);
        for (int leg = 1; leg < 20; ++leg) {
            constexpr double kStep = 1e-6;
            const auto x = [&](double s) { return motion->at(leg * .1 + s).x; };
            const double before = (x(-kStep) - x(-2 * kStep)) / kStep;
            const double after = (x(2 * kStep) - x(kStep)) / kStep;
            EXPECT_NEAR(x(-kStep), x(kStep), .01) << "no jump";
            EXPECT_NEAR(before, after, .1) << "nor a sudden change of speed, px/s";
            // As fast as from the middle of the leg before to that of the leg after, about.
            const double between = (x(.1) - x(-.1)) / .2;
            EXPECT_NEAR(before, between, .1);
        }
    }
}

TEST(WanderMotion, StaysNearHome) {
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        const auto motion = wander_motion({}, 20, 10, {50, 20}, {0, 0, 100, 40}, Random{seed});
        motion->prepare(100);
        int away = 0;
        for (int i = 0; i < 1000; ++i) {
            const Pose p = motion->at(i * .1);
            away += p.x < -20 || p.x > 120 || p.y < -10 || p.y > 50;
        }
        EXPECT_LT(away, 100);
    }
}

TEST(WanderMotion, ThingsStartAtAnyAngleAndTheCameraUpright) {
    int turned = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const auto thing = wander_motion({}, 50, 10, {50, 50}, {0, 0, 100, 100}, Random{seed});
        const auto camera = wander_motion({}, 50, 10, {}, {}, Random{seed});
        thing->prepare(1);
        camera->prepare(1);
        turned += std::abs(thing->at(0).angle) > .3;
        EXPECT_EQ(camera->at(0).angle, 0);
    }
    EXPECT_GT(turned, 15);
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

TEST(WanderMotion, IsThereFromTheTimeOnBeforeWhichItWasForgotten) {
    WanderSettings settings;
    settings.linear_probability = 0;
    const auto whole = wander_motion(settings, 50, 20, {}, {}, Random{5});
    const auto part = wander_motion(settings, 50, 20, {}, {}, Random{5});
    whole->prepare(40);
    for (double t = 0; t < 20; t += .01) {
        part->prepare(t + 20);
        part->forget(t);
        ASSERT_EQ(whole->at(t).x, part->at(t).x) << t;
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
    const double far = way_from_start(settings);
    settings.tremble = 1;
    const double near = way_from_start(settings);
    EXPECT_LT(near, 250);
    settings.tremble = .5;
    EXPECT_GT(way_from_start(settings), near + (far - near) / 4);
    EXPECT_LT(way_from_start(settings), far - (far - near) / 4);
    settings.tremble = 1;
    settings.turn = {0, 0};
    EXPECT_LT(way_from_start(settings), 250) << "however straight others go";
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
    settings.pace_s = {1e4, 1e4};
    EXPECT_LT(share_below(10, settings), .05) << "a change in hours";
}

TEST(WanderMotion, TurnsAndZoomsAtItsPaceToo) {
    WanderSettings settings;
    settings.spin_share = settings.zoom_share = {.3, .3};
    settings.linear_probability = 1;
    const auto turn_and_zoom = [&] {
        double turn = 0, zoom = 0;
        for (std::uint64_t seed = 0; seed < 20; ++seed) {
            const auto motion = wander_motion(settings, 100, 50, {}, {}, Random{seed});
            motion->prepare(5);
            turn += std::abs(motion->at(5).angle);
            zoom += std::abs(std::log(motion->at(5).scale_x));
        }
        return std::pair{turn, zoom};
    };
    settings.pace = {.999, .999};
    settings.pace_s = {1e-9, 1e-9};  // from the first leg on
    const auto usual = turn_and_zoom();
    settings.pace = {.01, .01};
    const auto slow = turn_and_zoom();
    EXPECT_LT(slow.first, .1 * usual.first);
    EXPECT_LT(slow.second, .1 * usual.second);
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

TEST(PauseClock, IsThereFromTheTimeOnBeforeWhichItWasForgotten) {
    PauseClock whole{.2, .5, .03, Random{3}}, part{.2, .5, .03, Random{3}};
    whole.prepare(40);
    for (double t = 0; t < 20; t += .01) {
        part.prepare(t + 20);
        part.forget(t);
        ASSERT_EQ(whole.at(t), part.at(t)) << t;
    }
}

TEST(LightChanges, IsThereFromTheTimeOnBeforeWhichItWasForgotten) {
    LightChanges whole{.7, .1, Random{4}}, part{.7, .1, Random{4}};
    whole.prepare(40);
    for (double t = 0; t < 20; t += .01) {
        part.prepare(t + 20);
        part.forget(t);
        ASSERT_EQ(whole.log_gain(t), part.log_gain(t)) << t;
    }
}

TEST(LightChanges, BeginsAnywhereInItsDepth) {
    double mean = 0;
    for (std::uint64_t seed = 0; seed < 400; ++seed) {
        LightChanges light{.8, .1, Random{seed}};
        light.prepare(1);
        mean += light.log_gain(0) / 400;
    }
    EXPECT_NEAR(mean, -.4, .05);
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
