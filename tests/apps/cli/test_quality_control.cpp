// Quality follows the load, in made time, and does not flap.
#include "apps/cli/run/quality/quality_control.h"
#include "tests/apps/cli/quality_cost.h"

#include <gtest/gtest.h>

namespace eventide::app {
namespace {

using namespace std::chrono_literals;

/// A machine on which frames and encoding take so many times what the profile says.
class Machine {
public:
    explicit Machine(std::vector<QualityLevel> levels = quality_levels({1, 0}, true, true),
                     QualityDemand demand = {20, 40, 1, {}}, std::size_t at = 0)
        : demand_{demand}, control_{kCost, std::move(levels), at, demand} {}

    /// Returns how often the level was changed.
    int run(double seconds, double frames, double encoding = 1, bool merges = false) {
        int changes = 0;
        for (int i = 0; i < int(seconds * 4); ++i) {
            const NetworkLoad load = load_of(kCost, control_.level(), demand_);
            now_.at += Seconds{0.25};
            now_.windows += 5;
            now_.merged += merges ? 1 : 0;
            now_.frames += std::uint64_t(10 >> control_.level().halvings);
            now_.encode += Seconds{load.encode * encoding / 4};
            now_.present += Seconds{load.frames * frames / 4};
            changes += control_.look(now_) ? 1 : 0;
        }
        return changes;
    }
    void wait(double seconds) {
        for (int i = 0; i < int(seconds * 4); ++i) {
            now_.at += Seconds{0.25};
            EXPECT_FALSE(control_.look(now_)) << "nothing was measured";
        }
    }
    const QualityLevel& level() const { return control_.level(); }

private:
    QualityDemand demand_;
    QualityControl control_;
    QualityMeasure now_;
};

TEST(QualityControl, LeavesAloneWhatHolds) {
    Machine machine;
    EXPECT_EQ(machine.run(60, 1), 0);
    EXPECT_EQ(machine.level(), (QualityLevel{1, 0}));
}

TEST(QualityControl, ASlowMomentChangesNothing) {
    Machine machine;
    machine.run(10, 1);
    EXPECT_EQ(machine.run(0.75, 6), 0);
    EXPECT_EQ(machine.run(20, 1), 0);
}

TEST(QualityControl, APauseIsNoLoadWhateverWasBeforeIt) {
    Machine machine;
    machine.run(5, 1);
    EXPECT_EQ(machine.run(1, 6), 0) << "not for long enough";
    machine.wait(20);
    EXPECT_EQ(machine.level(), (QualityLevel{1, 0}));
}

TEST(QualityControl, GoesDownWithinSecondsOfLoadAndUpAgainAfterwards) {
    Machine machine;
    machine.run(5, 1);
    EXPECT_GE(machine.run(4, 4.6), 1) << "0.92 of their thread";
    EXPECT_EQ(machine.level(), (QualityLevel{1, 1}));
    EXPECT_EQ(machine.run(20, 1), 1);
    EXPECT_EQ(machine.level(), (QualityLevel{1, 0}));
}

TEST(QualityControl, GoesUpAfterFiveSecondsInARowThatWereEasy) {
    Machine machine;
    machine.run(5, 1);
    machine.run(4, 4.6);
    ASSERT_EQ(machine.level(), (QualityLevel{1, 1}));
    EXPECT_EQ(machine.run(4, 1), 0);
    EXPECT_EQ(machine.run(.5, 1, 1, true), 0) << "windows were merged";
    EXPECT_EQ(machine.run(4.5, 1), 0) << "they count anew";
    EXPECT_EQ(machine.run(1, 1), 1);
    EXPECT_EQ(machine.level(), (QualityLevel{1, 0}));
}

TEST(QualityControl, GoesUpASecondTimeNoSoonerThanTheFirst) {
    Machine machine;
    machine.run(5, 1);
    machine.run(4, 10);
    ASSERT_EQ(machine.level(), (QualityLevel{1, 2}));
    for (int n = 0; n < 100 && machine.level() == QualityLevel{1, 2}; ++n) machine.run(.25, 3.4);
    ASSERT_EQ(machine.level(), (QualityLevel{1, 1}));
    EXPECT_EQ(machine.run(4, 1), 0);
    EXPECT_EQ(machine.run(2, 1), 1);
}

TEST(QualityControl, AStepUpThatWasTakenBackIsTriedAgainAfterTwiceTheTime) {
    Machine machine;
    const auto seconds_until_up = [&] {
        double seconds = 0;
        for (; seconds < 200 && machine.level() != QualityLevel{1, 0}; seconds += .5)
            machine.run(.5, 2.5);
        return seconds;
    };
    const auto load_until_down = [&] {
        for (int n = 0; n < 40 && machine.level() == QualityLevel{1, 0}; ++n) machine.run(.5, 5);
    };
    machine.run(5, 1);
    std::vector<double> waits;
    for (int i = 0; i < 7; ++i) {
        load_until_down();
        waits.push_back(seconds_until_up());
    }
    const std::vector<double> expected{5, 10, 20, 40, 60, 60, 60};
    for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(waits[i], expected[i], 1.5) << i;
    machine.run(70, 1);  // a minute without a change after that of the last wait: a quarter of 80
    load_until_down();
    EXPECT_NEAR(seconds_until_up(), 20, 1.5);
    machine.run(600, 1);
    load_until_down();
    EXPECT_NEAR(seconds_until_up(), 5, 1.5);
}

TEST(QualityControl, GoesBackToWhereItBeganWhereAQuarterIsLeftAndNotBefore) {
    Machine machine;
    machine.run(5, 1);
    machine.run(4, 4.6);
    ASSERT_EQ(machine.level(), (QualityLevel{1, 1}));
    EXPECT_EQ(machine.run(60, 3.9), 0) << "0.78 of the frames' thread at the full rate";
    EXPECT_EQ(machine.run(10, 3.6), 1) << "0.72";
}

TEST(QualityControl, GoesHigherThanItBeganWhereFortyPerCentAreLeftAndNotBefore) {
    Machine machine{quality_levels({1, 0}, true, true), {20, 40, 1, {}}, 1};
    ASSERT_EQ(machine.level(), (QualityLevel{1, 1}));
    EXPECT_EQ(machine.run(60, 3.4), 0) << "0.68 of the frames' thread at the full rate";
    EXPECT_EQ(machine.run(10, 2.8), 1) << "0.56";
}

TEST(QualityControl, GoesToTheLeastWhereNothingHoldsAndStays) {
    Machine machine;
    machine.run(20, 30);
    EXPECT_EQ(machine.level(), (QualityLevel{1.0 / 3, 2}));
    EXPECT_EQ(machine.run(60, 30), 0);
}

TEST(QualityControl, DoesNotFlapWhereTheLoadLiesBetweenTwoLevels) {
    // The lower level always looks easy from below, and never holds from above.
    Machine machine;
    int changes = 0;
    for (int i = 0; i < 600; ++i)
        changes +=
            machine.run(1, machine.level().halvings == 0 && machine.level().scale == 1 ? 5 : 2.5);
    EXPECT_LE(changes, 30) << "in ten minutes";
    EXPECT_GE(changes, 3) << "and it does try";
}

TEST(QualityControl, StaysBelowABudgetThatThreadsShare) {
    // By the profile 0.4 of a core, by two threads in half of the time.
    Machine machine{quality_levels({1, 0}, true, true), {20, 40, 2, 0.5}};
    machine.run(10, 0.5, 0.5);
    EXPECT_EQ(machine.level(), (QualityLevel{1, 0}));
    machine.run(60, 0.6, 0.6);
    EXPECT_EQ(machine.level(), (QualityLevel{1, 0})) << "0.48";
    machine.run(10, 0.65, 0.65);
    EXPECT_EQ(machine.level(), (QualityLevel{1, 2})) << "0.52";
}

TEST(QualityControl, FreesCoresStepByStepForEncodingThatTakesTooLong) {
    Machine machine;
    machine.run(3, 1, 6);
    EXPECT_EQ(machine.level(), (QualityLevel{1, 1}));
    machine.run(60, 1, 6);
    EXPECT_EQ(machine.level(), (QualityLevel{1.0 / 3, 2}));
}

TEST(QualityControl, NeverTakesMoreForFramesWhereEncodingTakesTooLong) {
    // A third of the size at the full rate takes more than a quarter of the frames at full size.
    ASSERT_GT(load_of(kCost, {1.0 / 3, 0}, {20, 40, 1, {}}).frames,
              load_of(kCost, {1, 2}, {20, 40, 1, {}}).frames);
    Machine machine;
    double before = load_of(kCost, machine.level(), {20, 40, 1, {}}).frames;
    for (int second = 0; second < 30; ++second) {
        machine.run(1, 1, 6);
        const double now = load_of(kCost, machine.level(), {20, 40, 1, {}}).frames;
        EXPECT_LE(now, before) << "at " << second << " s";
        before = now;
    }
    EXPECT_EQ(machine.level(), (QualityLevel{1.0 / 3, 2}));
}

TEST(QualityControl, WindowsThatHadToBeMergedCallForLess) {
    Machine machine;
    machine.run(5, 1);
    EXPECT_GE(machine.run(2, 1, 1, true), 1);
    EXPECT_NE(machine.level(), (QualityLevel{1, 0}));
}

TEST(QualityControl, SingleWindowsThatWereMergedCallForNothing) {
    QualityControl control{kCost, quality_levels({1, 0}, true, true), 0, {20, 40, 1, {}}};
    QualityMeasure now;
    for (int i = 0; i < 40; ++i) {
        now.at += Seconds{1};
        now.windows += 49;
        now.merged += 1;
        now.frames += 40;
        now.encode += Seconds{0.2};
        now.present += Seconds{0.2};
        EXPECT_FALSE(control.look(now));
    }
}

/// Twice the pace, and so twice the frames: the load is told as it is, not twice of that.
TEST(QualityControl, CountsThePaceOnce) {
    const QualityDemand demand{.windows = 40, .frames = 80, .threads = 1, .share = {}, .pace = 2};
    QualityControl control{kCost, quality_levels({1, 0}, true, true), 0, demand};
    const double expected = load_of(kCost, control.level(), demand).frames;
    QualityMeasure now;
    for (const double pace : {2., 1.}) {
        now.pace = pace;
        for (int i = 0; i < 20; ++i) {
            now.at += Seconds{1};
            now.windows += std::uint64_t(20 * pace);
            now.frames += std::uint64_t(40 * pace);
            now.encode += Seconds{load_of(kCost, control.level(), demand).encode * pace / 2};
            now.present += Seconds{expected * pace / 2};
            control.look(now);
        }
        EXPECT_NEAR(control.measured().frames, expected * pace / 2, .01 * expected);
    }
}

TEST(QualityControl, NothingFollowsFromSilence) {
    Machine machine;
    machine.run(5, 1);
    machine.wait(120);
    EXPECT_EQ(machine.run(5, 1), 0);
    EXPECT_GE(machine.run(4, 4.6), 1) << "but from the load behind it";
}

TEST(QualityControl, SingleMomentsOfStrainAreNotAddedUp) {
    Machine machine;
    for (int i = 0; i < 10; ++i) {
        EXPECT_EQ(machine.run(.5, 1, 1, true), 0) << "windows were merged";
        EXPECT_EQ(machine.run(1, 1), 0);
    }
}

TEST(QualityControl, EncodingMayTakeMostOfItsThreadWhereNoWindowCanBeLonger) {
    Machine machine;
    EXPECT_EQ(machine.run(20, 1, 4), 0) << "0.8";
    EXPECT_GE(machine.run(20, 1, 5), 1) << "1.0";
}

TEST(QualityControl, ChangesOnlyWhatIsLeftOpen) {
    Machine machine{quality_levels({1, 0}, false, true)};
    machine.run(30, 4.6);
    EXPECT_EQ(machine.level().halvings, 0U);
    EXPECT_LT(machine.level().scale, 1);
}

}  // namespace
}  // namespace eventide::app
