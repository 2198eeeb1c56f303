// How short event windows may be follows the load, too.
#include "apps/cli/run/quality/quality_control.h"
#include "tests/apps/cli/quality_cost.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace eventide::app {
namespace {

using namespace std::chrono_literals;

/// A scene that gives so many event windows a second, if they may be so short, each of which takes
/// so much of what the profile says; on two threads.
class Scene {
public:
    Scene()
        : levels_{quality_levels({1, 0}, true, true, min_windows(50ms))},
          control_{kCost, levels_, 6, demand_} {}

    int run(double seconds, double windows_per_s, double cost, double take_ms = 0) {
        int changes = 0;
        for (int i = 0; i < int(seconds * 2); ++i) {
            const double windows =
                std::min(windows_per_s, windows_at(control_.level(), demand_)) / 2;
            now_.at += Seconds{0.5};
            now_.windows = std::uint64_t(windows_ += windows);
            now_.frames += std::uint64_t(20 >> control_.level().halvings);
            now_.encode += Seconds{windows * cost * kCost.encode_ms * 1e-3 / cores_of(2)};
            now_.present += Seconds{0.1};
            now_.take += Seconds{windows * take_ms * 1e-3};
            changes += control_.look(now_) ? 1 : 0;
        }
        return changes;
    }
    /// Of the recording, from now on.
    void plays_at(double pace) { now_.pace = demand_.pace = pace; }
    const QualityLevel& level() const { return control_.level(); }

private:
    QualityDemand demand_{20, 40, 2, {}};
    std::vector<QualityLevel> levels_;
    QualityControl control_;
    QualityMeasure now_;
    double windows_ = 0;
};

TEST(QualityControl, ShortensEventWindowsNoFurtherThanHoldsWhenAllMoves) {
    // By the profile 10 ms a window are 0.59 of the encoder's time at 10 ms, and 1.18 at 5.
    Scene scene;
    ASSERT_EQ(scene.level().min_window, 20ms);
    EXPECT_EQ(scene.run(20, 20, 0.1), 1) << "little moves, and windows are few and cheap";
    EXPECT_EQ(scene.level(), (QualityLevel{1, 0, 10ms}));
    EXPECT_EQ(scene.run(60, 1000, 1), 0) << "then all moves at once, and it holds";
}

TEST(QualityControl, LengthensEventWindowsWhereEncodingTakesTooLongAndShortensThemAgain) {
    Scene scene;
    scene.run(10, 1000, 2.5);  // 0.74 of the encoder's time at 20 ms: holds
    EXPECT_EQ(scene.level().min_window, 20ms);
    EXPECT_EQ(scene.run(5, 1000, 4), 1);
    EXPECT_EQ(scene.level(), (QualityLevel{1, 0, 50ms})) << "nothing else is given up";
    EXPECT_GE(scene.run(120, 1000, 1), 1);
    EXPECT_EQ(scene.level(), (QualityLevel{1, 0, 10ms}));
}

TEST(QualityControl, EventWindowsAreNoShorterThanLeavesTheEncoderSomeTime) {
    Scene scene;
    EXPECT_EQ(scene.run(10, 1000, 2.8), 1);  // 0.82: holds, but longer windows would wait less
    EXPECT_EQ(scene.level(), (QualityLevel{1, 0, 30ms}));
}

TEST(QualityControl, CountsTheEventWindowsThatThereAre) {
    Scene scene;
    EXPECT_EQ(scene.run(60, 20, 5.1), 0) << "0.6 of the encoder's time, though 50 there may be";
    EXPECT_EQ(scene.level(), (QualityLevel{1, 0, 20ms}));
}

TEST(QualityControl, GivesUpFramesOnlyWhereTheLongestEventWindowsAreTooMany) {
    Scene scene;
    scene.run(10, 1000, 9);  // 1.06 of the encoder's time at 50 ms
    EXPECT_EQ(scene.level().min_window, 50ms);
    EXPECT_GT(scene.level().halvings, 0U);
}

TEST(QualityControl, KnowsWhatEventWindowsTakeOfTheFramesThread) {
    Scene scene;
    scene.run(20, 1000, 0.5, 12);  // 0.6 and 0.2 at 20 ms; 1.2 and 0.2 at 10
    EXPECT_EQ(scene.level(), (QualityLevel{1, 0, 20ms}));
    scene.run(5, 1000, 0.5, 20);
    EXPECT_EQ(scene.level(), (QualityLevel{1, 0, 50ms}));
}

TEST(QualityControl, ShortensEventWindowsWhereARecordingIsPlayedMoreSlowly) {
    Scene scene;
    scene.run(20, 1000, 1);
    ASSERT_EQ(scene.level(), (QualityLevel{1, 0, 10ms}));
    scene.plays_at(.5);
    scene.run(60, 1000, 1);
    EXPECT_EQ(scene.level(), (QualityLevel{1, 0, 5ms})) << "as many a second of the clock";
}

}  // namespace
}  // namespace eventide::app
