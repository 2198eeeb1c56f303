// The simulated test set: which frames count and which photographs it shows, as docs/accuracy.md
// says, and evaluations on it.
#include "apps/evaluate/simulated_sequence.h"
#include "src/core/error.h"
#include "tests/apps/evaluate/recordings.h"
#include "tests/apps/evaluate/small_model.h"

#include <gtest/gtest.h>

#include <vector>

namespace eventide::test {
namespace {

TEST(SimulatedSet, ScoresEachFifthWindowFromTheNinthOn) {
    const SimulatedSettings what;
    std::vector<int> scored;
    for (int k = 0; k < what.event_windows; ++k)
        if (is_scored(what, k)) scored.push_back(k + 1);
    std::vector<int> expected;
    for (int window = 9; window <= 150; window += 5) expected.push_back(window);
    EXPECT_EQ(scored, expected);
}

TEST(SimulatedSet, ShowsTheLastImagesOfAFolderByName) {
    const fs::path folder = fresh_folder("photographs");
    for (int i = 0; i < 5; ++i)
        write_image(folder / ("image_" + std::to_string(i) + ".png"), test_image(20 + i, 30, i));
    SimulatedSettings what;
    what.images = folder;
    const auto heights = [&] {
        std::vector<int> all;
        const auto textures = test_textures(what);
        for (std::size_t i = 0; i < textures->size(); ++i) all.push_back((*textures)[i].height());
        return all;
    };
    EXPECT_EQ(heights(), (std::vector<int>{20, 21, 22, 23, 24}));
    what.last_images = 2;
    EXPECT_EQ(heights(), (std::vector<int>{23, 24}));
    what.last_images = 9;
    EXPECT_EQ(heights().size(), 5U);
}

TEST(SimulatedSet, WindowsFollowEachOtherAndHoldTheirEventsWithoutNoiseWhereAsked) {
    SimulatedSettings what = small_simulation();
    const auto events_of = [&](std::optional<NoiseFilterSettings> noise_filter) {
        std::size_t events = 0;
        SensorTime end = SensorTime::min();
        for_each_simulated_window(
            what, test_textures(what), 0, noise_filter,
            [&](const EventWindow& cut, const SimulatedStream&) {
                EXPECT_EQ(cut.window.width(), what.frame_width);
                EXPECT_TRUE(end == SensorTime::min() || cut.window.begin == end);
                end = cut.window.end;
                for (const Event& event : cut.events)
                    EXPECT_TRUE(event.t > cut.window.begin && event.t <= cut.window.end);
                events += cut.events.size();
                return true;
            });
        return events;
    };
    const std::size_t all = events_of({});
    EXPECT_GT(all, 1000U);
    EXPECT_LT(events_of(parse_noise_filter("1ms", true)), all);
}

TEST(EvaluateSimulated, GivesTheSameNumbersEveryTimeAndInAnyOrder) {
    EvaluateSettings how = small_model();
    const EvaluateReport one = evaluate_simulated(small_simulation(), how);
    how.parallel_for = [](int n, const std::function<void(int)>& body) {
        for (int i = n - 1; i >= 0; --i) body(i);
    };
    const EvaluateReport two = evaluate_simulated(small_simulation(), how);
    EXPECT_EQ(one.overall.frames, 12);
    EXPECT_EQ(json(one), json(two));
    EXPECT_EQ(frame_csv(one), frame_csv(two));
    EXPECT_NE(one.sequences[0].scores.raw.mse, one.sequences[1].scores.raw.mse);
}

TEST(EvaluateSimulated, ComparesAtAnyLookaheadScaleAndTime) {
    EvaluateSettings how = small_model();
    how.lookahead = 2;
    SimulatedSettings what = small_simulation();
    what.scale = 1.5;
    what.phases = {.25, 1};
    const EvaluateReport report = evaluate_simulated(what, how);
    EXPECT_EQ(report.overall.frames, 24);
    EXPECT_NEAR(report.sequences[0].frames[0].time_s, 3.25 * .05, 1e-5);
    EXPECT_EQ(report.sequences[0].not_rendered, 0);
    what.phases = {0};
    EXPECT_THROW(evaluate_simulated(what, how), Error);
    how.lamp_flicker = "sometimes";
    EXPECT_THROW(evaluate_simulated(small_simulation(), how), Error);
}

TEST(EvaluateSimulated, SaysNothingOfLampsWhichAreLookedForInRecordingsAlone) {
    RecordingSettings what;
    what.recordings = {write_recording(fresh_folder("lamps"), .6, .002, .1)};
    EvaluateSettings how = small_model();
    how.lamp_flicker = "5ms";
    const auto names_it = [](const EvaluateReport& report) {
        return report.settings.find("lamp flicker 5ms") != std::string::npos;
    };
    EXPECT_TRUE(names_it(evaluate_recordings(what, how)));
    EXPECT_FALSE(names_it(evaluate_simulated(small_simulation(), how)));
}

TEST(EvaluateSimulated, TooFewEventWindowsToScoreOneAreRefused) {
    SimulatedSettings what = small_simulation();
    what.event_windows = what.skip_frames + what.score_every - 1;
    EXPECT_THROW(evaluate_simulated(what, {}), Error);
}

}  // namespace
}  // namespace eventide::test
