// Motion that wanders.
#include "src/simulate/scene/motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

namespace eventide {
namespace {

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

}  // namespace
}  // namespace eventide
