// Whole evaluations: on a small recording made here, on folders, and what is written about them.
#include "apps/evaluate/csv_field.h"
#include "apps/evaluate/evaluate.h"
#include "apps/evaluate/reference_sequence.h"
#include "pipeline/filters/event_filter.h"
#include "src/core/error.h"
#include "tests/apps/evaluate/recordings.h"
#include "tests/apps/evaluate/small_model.h"
#include "tests/metrics/images.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace eventide::test {
namespace {

TEST(ReferenceWindows, HoldEachEventBetweenTheImagesExactlyOnce) {
    const fs::path folder = write_recording(fresh_folder("slices"), .5, .001, .1);
    const ReferenceSequence sequence = read_reference_sequence(folder);
    EXPECT_EQ(sequence.width, kWidth);
    EXPECT_EQ(sequence.images.size(), 5U);
    std::vector<EventWindow> event_windows;
    for_each_reference_window(
        sequence, [&](const EventWindow& event_window) { event_windows.push_back(event_window); });
    ASSERT_EQ(event_windows.size(), 5U);
    EXPECT_TRUE(event_windows[0].events.empty());
    std::size_t events = 0;
    for (std::size_t i = 0; i < event_windows.size(); ++i) {
        EXPECT_EQ(event_windows[i].window.end, sequence.images[i].t);
        if (i > 0) {
            EXPECT_EQ(event_windows[i].window.begin, event_windows[i - 1].window.end);
        }
        for (const Event& event : event_windows[i].events) {
            EXPECT_GT(event.t, event_windows[i].window.begin);
            EXPECT_LE(event.t, event_windows[i].window.end);
        }
        events += event_windows[i].events.size();
    }
    EXPECT_EQ(events, 400U);  // (0, .4] s, one each millisecond
}

TEST(ReferenceSequence, IsCalledAsItsFolder) {
    const fs::path folder = write_recording(fresh_folder("at.5"), .5, .001, .1);
    EXPECT_EQ(read_reference_sequence(folder).name, "eventide_at.5");
    EXPECT_EQ(read_reference_sequence(folder / "").name, "eventide_at.5");
    EXPECT_EQ(sequence_name(folder / "."), "eventide_at.5");
    EXPECT_EQ(sequence_name("recordings/speed.5.aedat4"), "speed.5");
}

TEST(ReferenceSequence, CountsTimesFromItsFirstEventOrImage) {
    const fs::path folder = write_recording(fresh_folder("late_events"), .5, .001, .1);
    std::ofstream{folder / "events.txt"} << "0.15 1 2 1\n0.25 3 4 0\n0.35 3 4 1\n";
    const ReferenceSequence whole = read_reference_sequence(folder);
    EXPECT_EQ(whole.first, from_us(0));
    EXPECT_EQ(whole.images.size(), 5U);
    const ReferenceSequence part = read_reference_sequence(folder, .2, .3);
    EXPECT_EQ(part.first, from_us(0));
    ASSERT_EQ(part.images.size(), 2U);
    EXPECT_EQ(part.images[0].t, from_us(200'000));
    ASSERT_EQ(part.events.size(), 1U);
    EXPECT_EQ(part.events[0].t, from_us(250'000));
}

TEST(CutWindows, EndWhereTheyWouldWithoutTheNoiseFilter) {
    ReferenceSequence sequence{"noise", 64, 48, {}, {}, {}, {}, {}};
    const auto add = [&](std::int64_t t_us, int x, int y) {
        sequence.events.push_back(
            {from_us(t_us), std::uint16_t(x), std::uint16_t(y), Polarity::on});
    };
    const auto move_at = [&](std::int64_t t_us) {  // neighbours, which support each other
        for (int i = 0; i < 6; ++i) add(t_us + i, 10 + i % 3, 10 + i / 3);
    };
    move_at(0);
    for (int i = 1; i < 500; ++i) add(7000 * i, i * 29 % 64, i * 31 % 48);  // 3.5 s of noise
    move_at(3'500'000);
    sequence.images.emplace_back().t = from_us(3'500'006);
    const auto filter = event_filter({.hot_pixels = "off", .noise_filter = "1ms"}, {}, 64, 48);
    std::vector<Window> of_all, of_filtered;
    std::size_t events = 0;
    for_each_cut_window(sequence, "10ms", nullptr,
                        [&](const EventWindow& cut) { of_all.push_back(cut.window); });
    for_each_cut_window(sequence, "10ms", filter.get(), [&](const EventWindow& cut) {
        of_filtered.push_back(cut.window);
        events += cut.events.size();
    });
    EXPECT_LT(events, 20U);
    ASSERT_EQ(of_filtered.size(), of_all.size());
    for (std::size_t i = 0; i < of_all.size(); ++i) EXPECT_EQ(of_filtered[i].end, of_all[i].end);
}

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
    how.warn = [&](const std::string& text) { warnings.push_back(text); };
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

TEST(EvaluateFolders, FindNothingBetweenEqualFolders) {
    const fs::path folder = fresh_folder("folders");
    for (const char* side : {"frames", "references"})
        for (const char* sequence : {"one", "two"}) {
            fs::create_directories(folder / side / sequence);
            for (int i = 0; i < 3; ++i)
                write_image(folder / side / sequence / (std::to_string(i) + ".png"),
                            test_image(kHeight, kWidth, i));
        }
    const EvaluateReport report = evaluate_folders(folder / "frames", folder / "references", {});
    EXPECT_EQ(report.overall.frames, 6);
    EXPECT_EQ(report.overall.raw.mse, 0);
    EXPECT_NEAR(report.overall.raw.ssim, 1, 1e-9);
    EXPECT_FALSE(report.overall.picp80);
    EXPECT_EQ(
        evaluate_folders(folder / "frames/one/", folder / "references/one/", {}).overall.sequence,
        "one");

    cv::Mat deep;
    cv::imread((folder / "references/one/0.png").string(), cv::IMREAD_GRAYSCALE)
        .convertTo(deep, CV_16U, 257);
    cv::imwrite((folder / "frames/one/0.png").string(), deep);
    EXPECT_LT(
        evaluate_folders(folder / "frames/one", folder / "references/one", {}).overall.raw.mse,
        1e-12)
        << "16 bits are as white as 8";
    write_image(folder / "frames" / "one" / "9.png", test_image(kHeight, kWidth, 9));
    EXPECT_THROW(evaluate_folders(folder / "frames", folder / "references", {}), Error);
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

TEST(EvaluateSimulated, TooFewEventWindowsToScoreOneAreRefused) {
    SimulatedSettings what = small_simulation();
    what.event_windows = what.skip_frames + what.score_every - 1;
    EXPECT_THROW(evaluate_simulated(what, {}), Error);
}

TEST(Report, IsJsonWithTheAgreedKeysAndNullForWhatWasNotMeasured) {
    const fs::path folder = write_recording(fresh_folder("json"), .5, .002, .1);
    RecordingSettings what;
    what.recordings = {folder};
    const EvaluateReport report = evaluate_recordings(what, small_model());
    const auto parsed = nlohmann::json::parse(json(report));
    for (const auto* object : {&parsed, &parsed.at("sequences").at(0)}) {
        for (const char* key : {"sequence", "frames", "picp80", "ll", "lpips_corr", "correlation"})
            EXPECT_TRUE(object->contains(key)) << key;
        for (const char* group : {"raw", "affine"})
            for (const char* key : {"mse", "ssim", "lpips"})
                EXPECT_TRUE(object->at(group).contains(key)) << group << key;
        EXPECT_TRUE(object->at("raw").at("lpips").is_null());
        EXPECT_EQ(object->at("frames"), report.overall.frames);
    }
    EXPECT_NE(text_table(report).find("eventide_json"), std::string::npos);
    const std::string table = csv(report), frames = frame_csv(report);
    EXPECT_EQ(std::ranges::count(table, '\n'), 2);
    EXPECT_EQ(std::ranges::count(frames, '\n'), 1 + report.overall.frames);
}

TEST(Report, NamesSequencesInOneColumnWhateverTheyAreCalled) {
    EvaluateReport report;
    SequenceReport& sequence = report.sequences.emplace_back();
    sequence.scores.sequence = "desk, \"slow\"";
    sequence.frames.emplace_back();
    EXPECT_EQ(csv_field("slow\rdesk"), "\"slow\rdesk\"");
    EXPECT_EQ(csv_field("desk"), "desk");
    const std::string name = "\n\"desk, \"\"slow\"\"\",";
    EXPECT_NE(csv(report).find(name), std::string::npos) << csv(report);
    EXPECT_NE(frame_csv(report).find(name), std::string::npos) << frame_csv(report);
}

}  // namespace
}  // namespace eventide::test
