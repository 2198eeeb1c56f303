// Whole evaluations of small recordings made here, and of real ones.
#include "apps/evaluate/evaluate.h"
#include "apps/evaluate/evaluate_recordings.h"
#include "src/core/error.h"
#include "tests/apps/evaluate/recordings.h"
#include "tests/apps/evaluate/small_model.h"
#include "tests/support/flickering_light.h"
#include "tests/support/keep_in.h"

#include <gtest/gtest.h>

namespace eventide::test {
namespace {

TEST(EvaluateRecordings, ScoresEveryImageThatIsNotSkipped) {
    const fs::path folder = write_recording(fresh_folder("recording"), .9, .001, .1);
    for (const auto& [skip, expected] :
         {std::pair{0, 9}, {3, 6}, {100, 1}, {RecordingSettings::kSkipHalf, 5}}) {
        RecordingSettings what;
        what.recordings = {folder};
        what.skip_images = skip;
        const EvaluateReport report = evaluate_recordings(what, small_model());
        ASSERT_EQ(report.sequences.size(), 1U);
        EXPECT_EQ(report.overall.frames, expected);
        EXPECT_EQ(report.overall.sequence, "eventide_recording");
        EXPECT_TRUE(report.overall.picp80 && report.overall.ll);
        EXPECT_FALSE(report.overall.raw.lpips);
        EXPECT_LE(report.overall.affine.mse, report.overall.raw.mse);
    }
}

TEST(EvaluateRecordings, SayWhereFramesAreTheMeanOfMirroredNetworks) {
    RecordingSettings what;
    what.recordings = {write_recording(fresh_folder("mirrored"), .9, .001, .1)};
    const auto says = [&](int networks) {
        EvaluateSettings how = small_model();
        how.engine.self_ensemble = networks;
        return evaluate_recordings(what, how).settings.find(", self-ensemble of 2") !=
               std::string::npos;
    };
    EXPECT_FALSE(says(1));
    EXPECT_TRUE(says(2));
}

TEST(EvaluateRecordings, WarnWhereMoreIsLeftOutThanTaken) {
    const fs::path folder = write_recording(fresh_folder("left_out"), .9, .01, .1);
    RecordingSettings what;
    what.recordings = {folder};
    EvaluateSettings how = small_model();
    std::vector<std::string> warnings;
    how.warn = keep_in(warnings);
    evaluate_recordings(what, how);
    EXPECT_TRUE(warnings.empty()) << warnings.front();
    {
        std::ofstream events{folder / "events.txt", std::ios::app};
        for (int i = 0; i < 360; ++i) events << "0.9 " << kWidth << " 3 1\n";
    }
    evaluate_recordings(what, how);
    ASSERT_FALSE(warnings.empty());
    EXPECT_EQ(warnings.back().find(folder.string() +
                                   ": 80 % of it was left out as damaged: out_of_range 360"),
              0U)
        << warnings.back();
}

TEST(EvaluateRecordings, WithOtherWindowsAlsoComparesAtTheImagesTimes) {
    const fs::path folder = write_recording(fresh_folder("windows"), .9, .001, .1);
    RecordingSettings what;
    what.recordings = {folder};
    what.window = "30ms";
    what.skip_images = 1;
    for (const int lookahead : {0, 2}) {
        EvaluateSettings how = small_model();
        how.lookahead = lookahead;
        const EvaluateReport report = evaluate_recordings(what, how);
        EXPECT_EQ(report.overall.frames, 8);
        EXPECT_NEAR(report.sequences[0].frames[0].time_s, .1, 1e-6);
    }
}

TEST(EvaluateRecordings, ScoreFromTheMicrosecondAskedForOn) {
    RecordingSettings what;
    what.recordings = {write_recording(fresh_folder("from"), .9, .001, .25)};
    what.skip_images = 0;
    const auto frames_from = [&](double from_s) {
        what.from_s = from_s;  // which no binary fraction is
        return evaluate_recordings(what, small_model()).overall.frames;
    };
    EXPECT_EQ(frames_from(.25), 3);
    EXPECT_EQ(frames_from(.250001), 2);
}

TEST(EvaluateRecordings, CompareImagesThatCameAfterTheLastEvent) {
    const fs::path folder = write_recording(fresh_folder("after_events"), .9, .001, .1);
    {
        std::ofstream images{folder / "images.txt", std::ios::app};
        images << "0.95 images/frame_108.png\n";
    }
    RecordingSettings what;
    what.recordings = {folder};
    what.skip_images = 0;
    what.window = "20ms";
    const EvaluateReport report = evaluate_recordings(what, small_model());
    EXPECT_EQ(report.overall.frames, 10);
    EXPECT_EQ(report.sequences[0].not_rendered, 0);
}

TEST(EvaluateRecordings, SayHowManyImagesLieOutsideTheEventWindows) {
    const fs::path folder = fresh_folder("early_images");
    write_recording(folder, .9, .001, .1);
    {
        std::ofstream events{folder / "events.txt"};  // from .45 s on
        events << std::fixed;
        for (int i = 450; i < 900; ++i) events << i * .001 << " 3 4 1\n";
    }
    RecordingSettings what;
    what.recordings = {folder};
    what.skip_images = 0;
    what.window = "20ms";
    const EvaluateReport report = evaluate_recordings(what, small_model());
    EXPECT_EQ(report.overall.frames, 4) << "those at .5 to .8 s";
    EXPECT_EQ(report.sequences[0].not_rendered, 5);
    ASSERT_EQ(report.notes.size(), 1U);
    EXPECT_EQ(report.notes[0],
              "eventide_early_images: 5 references lie outside the event windows "
              "and were not compared");
}

TEST(EvaluateRecordings, LoseNoEventThatWaitedForTheSecondOfALampsPair) {
    ReferenceSequence sequence{"lamp", 32, 24, {}, {}, {}, {}, {}};
    sequence.events = lamp_events({});
    const SensorTime end = sequence.events.back().t + SensorDuration{1000};
    for (std::uint16_t x = 0; x < 20; ++x) sequence.events.push_back({end, x, 3, Polarity::on});
    for (const SensorTime t : {end - SensorDuration{100'000}, end - SensorDuration{1}, end}) {
        ReferenceImage& image = sequence.images.emplace_back();
        image.t = t;
        image.pixels = Array2<std::uint16_t>(24, 32);
    }
    const Evaluation evaluation{"a lamp", small_model()};
    const SequenceResult result = evaluate_sequence(evaluation, sequence, "reference", {});
    ASSERT_EQ(result.report.frames.size(), 3U);
    EXPECT_NEAR(result.report.frames[2].events_per_pixel, 20. / (32 * 24), 1e-9);
}

TEST(EvaluateRecordings, CountEventsByTheSensorsPixels) {
    RecordingSettings what;
    what.recordings = {write_recording(fresh_folder("per_pixel"), .35, .001, .1)};
    const EvaluateReport report = evaluate_recordings(what, small_model());
    ASSERT_FALSE(report.sequences[0].frames.empty());
    EXPECT_NEAR(report.sequences[0].frames.back().events_per_pixel, 100. / (kWidth * kHeight),
                1e-9);
}

TEST(EvaluateRecordings, APartIsScoredByAModelThatSawWhatWasBefore) {
    RecordingSettings what;
    what.recordings = {write_recording(fresh_folder("part"), 1.2, .001, .1)};
    what.skip_images = 0;
    const EvaluateReport whole = evaluate_recordings(what, small_model());
    what.from_s = .6;
    const EvaluateReport part = evaluate_recordings(what, small_model());
    ASSERT_EQ(whole.overall.frames, 12);
    ASSERT_EQ(part.overall.frames, 6);
    for (std::size_t i = 0; i < 6; ++i)
        EXPECT_EQ(part.sequences[0].frames[i].raw.mse, whole.sequences[0].frames[6 + i].raw.mse);
}

TEST(EvaluateRecordings, TakeTheWindowsThatTheModelWasTrainedFor) {
    RecordingSettings what;
    what.recordings = {write_recording(fresh_folder("windows_of_model"), .9, .001, .1)};
    EvaluateSettings how = small_model();
    Model model = load_model(how.model);
    model.config.window = "30ms";
    save_model(how.model, model);
    const auto evaluated = [&](const char* window) {
        what.window = window;
        return evaluate_recordings(what, how);
    };
    const EvaluateReport expected = evaluated("30ms"), found = evaluated("model");
    EXPECT_EQ(json(found), json(expected));
    EXPECT_NE(found.overall.raw.mse, evaluated("50ms").overall.raw.mse);
}

TEST(EvaluateRecordings, ImagesThatAreGivenAreNotScoredAndCorrectTheOthers) {
    const fs::path folder = write_recording(fresh_folder("given"), .9, .05, .1);
    for (const auto& image : fs::directory_iterator{folder / "images"})  // a still scene
        write_image(image.path(), test_image(kHeight, kWidth, 1));
    RecordingSettings what;
    what.recordings = {folder};
    what.skip_images = 1;
    for (const int lookahead : {0, 2}) {
        EvaluateSettings how = small_model();
        how.lookahead = lookahead;
        what.given_images = 0;
        const EvaluateReport without = evaluate_recordings(what, how);
        what.given_images = 3;  // of nine images those with numbers 0, 3 and 6
        const EvaluateReport with = evaluate_recordings(what, how);
        EXPECT_EQ(without.overall.frames, 8);
        EXPECT_EQ(with.overall.frames, 6);
        EXPECT_LT(with.overall.raw.mse, .1 * without.overall.raw.mse) << "lookahead " << lookahead;
    }
}

TEST(EvaluateRecordings, OfSeveralWeighFrames) {
    const fs::path folder = fresh_folder("several");
    RecordingSettings what;
    what.recordings = {write_recording(folder / "a", .4, .002, .1),
                       write_recording(folder / "b", .9, .002, .1)};
    what.skip_images = 0;
    const EvaluateReport report = evaluate_recordings(what, small_model());
    ASSERT_EQ(report.sequences.size(), 2U);
    const SequenceScores &a = report.sequences[0].scores, &b = report.sequences[1].scores;
    EXPECT_EQ(report.overall.frames, a.frames + b.frames);
    EXPECT_NEAR(report.overall.raw.mse,
                (a.frames * a.raw.mse + b.frames * b.raw.mse) / (a.frames + b.frames), 1e-12);
    EXPECT_EQ(report.overall.sequence, "all");
    EXPECT_EQ(report.observations.sigma_scale.pixels(),
              report.sequences[0].sigma_scale.pixels() + report.sequences[1].sigma_scale.pixels());
}

TEST(EvaluateRecordings, LeaveOutNoiseWhereAsked) {
    RecordingSettings what;
    what.recordings = {write_recording(fresh_folder("noise"), .9, .001, .1)};  // of lone events
    const auto events_per_pixel = [&](const char* filter) {
        EvaluateSettings how = small_model();
        how.noise_filter = filter;
        const EvaluateReport report = evaluate_recordings(what, how);
        EXPECT_EQ(report.settings.find("noise filter") != std::string::npos,
                  std::string{filter} == "1ms");
        return report.sequences.at(0).frames.at(0).events_per_pixel;
    };
    EXPECT_GT(events_per_pixel("off"), 0);
    EXPECT_EQ(events_per_pixel("model"), events_per_pixel("off")) << "trained on all events";
    EXPECT_EQ(events_per_pixel("1ms"), 0) << "in the second window, without the first event";
    EXPECT_THROW(events_per_pixel("a lot"), Error);
}

TEST(EvaluateRecordings, NameWhatCannotBeUsed) {
    RecordingSettings what;
    EXPECT_THROW(evaluate_recordings(what, small_model()), Error);
    what.recordings = {fs::path{testing::TempDir()} / "eventide_nothing_here"};
    EXPECT_THROW(evaluate_recordings(what, small_model()), Error);
    what.from_s = what.to_s = .5;
    try {
        evaluate_recordings(what, small_model());
        ADD_FAILURE() << "a part without length was taken";
    } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).find("--to: expected a time after --from"), 0U);
    }
    what.from_s = what.to_s = {};
    EvaluateSettings how = small_model();
    how.lookahead = 3;
    EXPECT_THROW(evaluate_recordings(what, how), Error);
}

TEST(RealRecordings, HaveTheirImagesScored) {
    const fs::path folder = shared_data() / "recordings" / "slider_depth_head";
    if (!fs::exists(folder)) GTEST_SKIP() << "no real recordings: " << folder << " is absent";
    RecordingSettings what;
    what.recordings = {folder};
    EvaluateSettings how = small_model();
    how.engine.engine = Engine::fast;
    const EvaluateReport report = evaluate_recordings(what, how);
    EXPECT_EQ(report.overall.frames, 2);  // of 5, the first 3 are skipped
    EXPECT_TRUE(report.notes.empty());
    // 50,000 events in 4 gaps between images.
    EXPECT_NEAR(report.sequences[0].frames[0].events_per_pixel, 50000. / 4 / (240 * 180), .1);
}

}  // namespace
}  // namespace eventide::test
