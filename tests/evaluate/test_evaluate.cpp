// Whole evaluations: on a small recording made here, on folders, and what is written about them.
#include "src/core/error.h"
#include "src/evaluate/evaluate.h"
#include "src/evaluate/evreal_sequence.h"
#include "src/evaluate/reference_sequence.h"
#include "src/model/model_file.h"
#include "tests/evaluate/pictures.h"
#include "tests/evaluate/small_model.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include <fstream>

namespace eventide {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 36, kHeight = 28;

void write_picture(const fs::path& path, const Array2<float>& image) {
    cv::Mat out(image.height(), image.width(), CV_8U);
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x)
            out.at<std::uint8_t>(y, x) = std::uint8_t(std::lround(255 * image(y, x)));
    cv::imwrite(path.string(), out);
}

/// A fresh folder of this name.
fs::path fresh_folder(const std::string& name) {
    const fs::path folder = fs::path{testing::TempDir()} / ("eventide_" + name);
    fs::remove_all(folder);
    fs::create_directories(folder);
    return folder;
}

/// A recording in the manner of the Event Camera Dataset: an event each `step_s`, an image each
/// `image_s`, for `span_s`.
fs::path write_recording(const fs::path& folder, double span_s, double step_s, double image_s) {
    fs::create_directories(folder / "images");
    std::ofstream events{folder / "events.txt"}, images{folder / "images.txt"};
    events << std::fixed;
    images << std::fixed;
    for (int i = 0; i * step_s < span_s; ++i)
        events << i * step_s << ' ' << i * 7 % kWidth << ' ' << i * 5 % kHeight << ' ' << i % 2
               << '\n';
    for (int i = 0; i * image_s < span_s; ++i) {
        const std::string name = "images/frame_" + std::to_string(100 + i) + ".png";
        images << i * image_s << ' ' << name << '\n';
        write_picture(folder / name, picture(kHeight, kWidth, 1 + i % 3));
    }
    return folder;
}

TEST(ReferenceSlices, HoldEachEventBetweenTheImagesExactlyOnce) {
    const fs::path folder = write_recording(fresh_folder("slices"), .5, .001, .1);
    const ReferenceSequence sequence = read_reference_sequence(folder);
    EXPECT_EQ(sequence.width, kWidth);
    EXPECT_EQ(sequence.images.size(), 5U);
    std::vector<Slice> slices;
    for_each_reference_slice(sequence, [&](const Slice& slice) { slices.push_back(slice); });
    ASSERT_EQ(slices.size(), 5U);
    EXPECT_TRUE(slices[0].events.empty());
    std::size_t events = 0;
    for (std::size_t i = 0; i < slices.size(); ++i) {
        EXPECT_EQ(slices[i].window.end, sequence.images[i].t);
        if (i > 0) {
            EXPECT_EQ(slices[i].window.begin, slices[i - 1].window.end);
        }
        for (const Event& event : slices[i].events) {
            EXPECT_GT(event.t, slices[i].window.begin);
            EXPECT_LE(event.t, slices[i].window.end);
        }
        events += slices[i].events.size();
    }
    EXPECT_EQ(events, 400U);  // (0, .4] s, one each millisecond
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

TEST(Evreal, CutsBySequenceNameAndStartsBeforeTheCut) {
    const fs::path dataset = fresh_folder("ecd");
    write_recording(dataset / "slider_depth", 3.05, .01, .25);
    write_recording(dataset / "unknown", 1.05, .01, .25);
    const EvaluateReport report = evaluate_evreal(dataset, small_model());
    ASSERT_EQ(report.sequences.size(), 2U);
    EXPECT_EQ(report.sequences[0].scores.sequence, "slider_depth");
    EXPECT_EQ(report.sequences[0].scores.frames, 7);  // 1 to 2.5 s, both included
    EXPECT_NEAR(report.sequences[0].frames.front().time_s, 1, 1e-6);
    EXPECT_EQ(report.sequences[1].scores.frames, 4);  // in full, but for the last
}

TEST(Evreal, StartsEachSequenceAnew) {
    const fs::path dataset = fresh_folder("ecd_twice");
    write_recording(dataset / "a", .6, .002, .1);
    write_recording(dataset / "b", .6, .002, .1);
    const EvaluateReport report = evaluate_evreal(dataset, small_model());
    EXPECT_EQ(report.sequences[0].scores.raw.mse, report.sequences[1].scores.raw.mse);
}

/// An .npy file of these bytes per number.
template <typename T>
void write_npy(const fs::path& path, const std::string& kind, const std::string& shape,
               const std::vector<T>& values) {
    const std::string header =
        "{'descr': '" + kind + "', 'fortran_order': False, 'shape': (" + shape + "), }\n";
    std::ofstream file{path, std::ios::binary};
    file << std::string{"\x93NUMPY\x01\x00", 8} << char(header.size()) << '\0' << header;
    file.write(reinterpret_cast<const char*>(values.data()),
               std::streamsize(values.size() * sizeof(T)));
}

TEST(Evreal, ReadsTheSameFromItsOwnArraysAsFromText) {
    const fs::path dataset = fresh_folder("ecd_npy");
    const ReferenceSequence text =
        read_reference_sequence(write_recording(dataset / "text", 1.05, .001, .1));
    std::vector<double> ts, images_ts;
    std::vector<std::int64_t> xy, p;
    std::vector<std::uint8_t> images;
    for (const Event& event : text.events) {
        ts.push_back(double(to_us(event.t)) * 1e-6);
        xy.insert(xy.end(), {event.x, event.y});
        p.push_back(event.polarity == Polarity::on ? 1 : 0);
    }
    for (const ReferenceImage& image : text.images) {
        images_ts.push_back(double(to_us(image.t)) * 1e-6);
        for (const std::uint16_t v : image.pixels.values()) images.push_back(std::uint8_t(v / 257));
    }
    const fs::path folder = dataset / "arrays";
    fs::create_directories(folder);
    const std::string n = std::to_string(ts.size()), m = std::to_string(images_ts.size());
    write_npy(folder / "events_ts.npy", "<f8", n + ",", ts);
    write_npy(folder / "events_xy.npy", "<i8", n + ", 2", xy);
    write_npy(folder / "events_p.npy", "<i8", n + ",", p);
    write_npy(folder / "images_ts.npy", "<f8", m + ", 1", images_ts);
    write_npy(folder / "images.npy", "|u1", m + ", 28, 36, 1", images);

    const ReferenceSequence arrays = read_evreal_sequence(folder, {}, {});
    EXPECT_EQ(arrays.events, text.events);
    EXPECT_EQ(arrays.images, text.images);
    const ReferenceSequence part = read_evreal_sequence(folder, .2, .5);
    const ReferenceSequence text_part = read_reference_sequence(dataset / "text", .2, .5);
    EXPECT_EQ(part.events, text_part.events);
    EXPECT_EQ(part.images, text_part.images);
    EXPECT_EQ(part.images.size(), 4U);

    const EvaluateReport report = evaluate_evreal(dataset, small_model());
    ASSERT_EQ(report.sequences.size(), 2U);
    EXPECT_EQ(report.sequences[0].scores.raw.mse, report.sequences[1].scores.raw.mse);
}

TEST(Evreal, RefusesArraysCutShort) {
    const fs::path folder = fresh_folder("short");
    write_npy<double>(folder / "events_ts.npy", "<f8", "1000000000000,", {1, 2});
    write_npy<std::uint8_t>(folder / "images.npy", "|u1", "1, 28, 36, 1", {0});
    write_npy<double>(folder / "images_ts.npy", "<f8", "1,", {0});
    EXPECT_THROW(read_evreal_sequence(folder, {}, {}), Error);
    write_npy(folder / "images.npy", "|u1", "1, 28, 36, 1", std::vector<std::uint8_t>(28 * 36));
    EXPECT_THROW(read_evreal_sequence(folder, {}, {}), Error);
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

TEST(Evreal, NamesWhatItCannotRead) {
    const fs::path dataset = fresh_folder("nothing");
    EXPECT_THROW(evaluate_evreal(dataset, small_model()), Error);
    std::ofstream{dataset / "bike_bay_hdr.bag"} << "x";
    try {
        evaluate_evreal(dataset, small_model());
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("ROS bags"), std::string::npos);
    }
}

TEST(EvaluateFolders, FindNothingBetweenEqualFolders) {
    const fs::path folder = fresh_folder("folders");
    for (const char* side : {"frames", "references"})
        for (const char* sequence : {"one", "two"}) {
            fs::create_directories(folder / side / sequence);
            for (int i = 0; i < 3; ++i)
                write_picture(folder / side / sequence / (std::to_string(i) + ".png"),
                              picture(kHeight, kWidth, i));
        }
    const EvaluateReport report = evaluate_folders(folder / "frames", folder / "references", {});
    EXPECT_EQ(report.overall.frames, 6);
    EXPECT_EQ(report.overall.raw.mse, 0);
    EXPECT_NEAR(report.overall.raw.ssim, 1, 1e-9);
    EXPECT_FALSE(report.overall.picp80);

    write_picture(folder / "frames" / "one" / "9.png", picture(kHeight, kWidth, 9));
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
}

TEST(Report, IsJsonWithTheAgreedKeysAndNullForWhatWasNotMeasured) {
    const fs::path folder = write_recording(fresh_folder("json"), .5, .002, .1);
    RecordingSettings what;
    what.recordings = {folder};
    const EvaluateReport report = evaluate_recordings(what, small_model());
    const auto parsed = nlohmann::json::parse(json(report));
    for (const auto* object : {&parsed, &parsed.at("sequences").at(0)}) {
        for (const char* key : {"sequence", "frames", "picp80", "ll", "lpips_corr"})
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

TEST(Calibration, BringsTheCoverageToEightTenthsAndIsWrittenIntoTheModel) {
    const fs::path folder = write_recording(fresh_folder("calibration"), .9, .001, .1);
    RecordingSettings what;
    what.recordings = {folder};
    EvaluateSettings how = small_model();
    const Calibration found = calibrate(evaluate_recordings(what, how), CalibrationRule::coverage);
    EXPECT_NEAR(found.picp80_after, .8, .01);
    const fs::path calibrated = fs::path{testing::TempDir()} / "eventide_calibrated.safetensors";
    write_calibrated(how.model, calibrated, found);
    how.model = calibrated;
    const EvaluateReport after = evaluate_recordings(what, how);
    EXPECT_NEAR(*after.overall.picp80, .8, .02);
    EXPECT_NEAR(*after.overall.ll, found.ll_after, .02);
    EXPECT_NE(load_model(calibrated).config.card.find("calibrated"), std::string::npos);
}

TEST(Calibration, CautiouslyHoldsInEverySequence) {
    const fs::path folder = fresh_folder("cautious");
    RecordingSettings what;
    what.recordings = {write_recording(folder / "a", .4, .002, .1),
                       write_recording(folder / "b", .9, .002, .3)};
    what.skip_images = 0;
    const EvaluateSettings how = small_model();
    const EvaluateReport report = evaluate_recordings(what, how);
    const double cautious = calibrate(report, CalibrationRule::cautious).factor;
    double largest = 0;
    for (const fs::path& one : what.recordings) {
        RecordingSettings alone = what;
        alone.recordings = {one};
        largest = std::max(
            largest, calibrate(evaluate_recordings(alone, how), CalibrationRule::coverage).factor);
    }
    EXPECT_EQ(cautious, largest);
    EXPECT_GE(cautious, calibrate(report, CalibrationRule::coverage).factor);
}

TEST(Calibration, ByLikelihoodIsNeverLessLikely) {
    const fs::path folder = write_recording(fresh_folder("likelihood"), .5, .001, .1);
    RecordingSettings what;
    what.recordings = {folder};
    const EvaluateReport report = evaluate_recordings(what, small_model());
    const Calibration found = calibrate(report, CalibrationRule::likelihood);
    EXPECT_GE(found.ll_after, found.ll_before);
    EXPECT_GE(found.ll_after, calibrate(report, CalibrationRule::coverage).ll_after);
    EXPECT_THROW(calibrate(EvaluateReport{}, CalibrationRule::coverage), Error);
}

}  // namespace
}  // namespace eventide
