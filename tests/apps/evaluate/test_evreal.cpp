// The protocol of EVREAL on small data sets in its layouts.
#include "apps/evaluate/evaluate.h"
#include "apps/evaluate/evreal_sequence.h"
#include "src/core/error.h"
#include "tests/apps/evaluate/recordings.h"
#include "tests/apps/evaluate/small_model.h"

#include <gtest/gtest.h>

#include <fstream>
#include <utility>

namespace eventide::test {
namespace {

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

TEST(Evreal, ACutIsScoredByAModelThatSawWhatWasBefore) {
    const fs::path dataset = fresh_folder("ecd_before");
    write_recording(dataset / "slider_depth", 3.05, .01, .25);
    write_recording(dataset / "unknown", 3.05, .01, .25);
    const EvaluateReport report = evaluate_evreal(dataset, small_model());
    ASSERT_EQ(report.sequences.size(), 2U);
    const auto &cut = report.sequences[0].frames, &whole = report.sequences[1].frames;
    ASSERT_EQ(cut.size(), 7U);
    ASSERT_EQ(whole.size(), 12U);
    for (std::size_t i = 0; i < cut.size(); ++i)
        EXPECT_EQ(cut[i].raw.mse, whole[4 + i].raw.mse) << cut[i].time_s;
}

TEST(Evreal, CutsASequenceHoweverItsFolderIsWritten) {
    const fs::path folder =
        write_recording(fresh_folder("ecd_one") / "slider_depth", 3.05, .01, .25);
    for (const fs::path& written : {folder, folder / "", folder / "."}) {
        const EvaluateReport report = evaluate_evreal(written, small_model());
        ASSERT_EQ(report.sequences.size(), 1U);
        EXPECT_EQ(report.sequences[0].scores.sequence, "slider_depth");
        EXPECT_EQ(report.sequences[0].scores.frames, 7) << written;
    }
}

TEST(Evreal, SaysWhichSequenceHasNoImageInItsCut) {
    const fs::path dataset = fresh_folder("ecd_short");
    write_recording(dataset / "boxes_6dof", 1.05, .01, .25);  // its cut begins at 5 s
    const EvaluateReport report = evaluate_evreal(dataset, small_model());
    EXPECT_EQ(report.overall.frames, 0);
    ASSERT_EQ(report.notes.size(), 1U);
    EXPECT_EQ(report.notes[0], "boxes_6dof: none of its images lies in the cut, 5 to 20 s");
}

TEST(Evreal, GoesOnWhereASequenceEndsBeforeWhatIsReadOfIt) {
    const fs::path dataset = fresh_folder("ecd_very_short");
    write_recording(dataset / "outdoor_day2", 1.05, .01, .25);  // read from 90 s on
    write_recording(dataset / "unknown", 1.05, .01, .25);
    const EvaluateReport report = evaluate_evreal(dataset, small_model());
    ASSERT_EQ(report.sequences.size(), 2U);
    EXPECT_EQ(report.sequences[0].scores.frames, 0);
    EXPECT_EQ(report.sequences[1].scores.frames, 4);
    ASSERT_EQ(report.notes.size(), 1U);
    EXPECT_EQ(report.notes[0], "outdoor_day2: none of its images lies in the cut, 100 to 160 s");
}

TEST(Evreal, SaysWhereASequenceEndsBeforeItsCutDoes) {
    const fs::path dataset = fresh_folder("ecd_partial");
    write_recording(dataset / "slider_depth", 1.8, .01, .25);
    const EvaluateReport report = evaluate_evreal(dataset, small_model());
    EXPECT_EQ(report.sequences[0].scores.frames, 4);
    ASSERT_EQ(report.notes.size(), 1U);
    EXPECT_EQ(report.notes[0],
              "slider_depth: its images end at 1.8 s, before the cut of EVREAL's tables, 1 to 2.5 "
              "s");
}

/// What is too short for its cut tells it.
TEST(Evreal, CutsItsSequencesWhereItsTablesDo) {
    const std::vector<std::pair<std::string, std::string>> cuts{
        {"boxes_6dof", "5 to 20 s"},        {"calibration", "5 to 20 s"},
        {"dynamic_6dof", "5 to 20 s"},      {"indoor_flying1", "10 to 70 s"},
        {"indoor_flying2", "10 to 70 s"},   {"indoor_flying3", "10 to 70 s"},
        {"indoor_flying4", "10 to 19.8 s"}, {"office_zigzag", "5 to 12 s"},
        {"outdoor_day2", "100 to 160 s"},   {"poster_6dof", "5 to 20 s"},
        {"shapes_6dof", "5 to 20 s"},       {"slider_depth", "1 to 2.5 s"}};
    const fs::path dataset = fresh_folder("ecd_cuts");
    std::vector<std::string> notes;
    for (const auto& [name, cut] : cuts) {
        write_recording(dataset / name, .2, .002, .1);
        notes.push_back(name + ": none of its images lies in the cut, " + cut);
    }
    EXPECT_EQ(evaluate_evreal(dataset, small_model()).notes, notes);

    const fs::path day = write_recording(fresh_folder("ecd_day") / "outdoor_day1", .2, .002, .1);
    EXPECT_EQ(
        evaluate_evreal(day, small_model()).notes.at(0),
        "outdoor_day1: its images end at 0.1 s, before the cut of EVREAL's tables, 0 to 60 s");
}

TEST(Evreal, NeverTakesTheLastImageOfAWholeRecording) {
    const fs::path dataset = fresh_folder("ecd_two");
    write_recording(dataset / "two_images", .2, .002, .1);
    EXPECT_EQ(evaluate_evreal(dataset, small_model()).overall.frames, 1);
}

TEST(Evreal, SaysWhereNumbersMustNotBeComparedWithItsTables) {
    const fs::path dataset = fresh_folder("ecd_lookahead");
    write_recording(dataset / "a", .3, .002, .1);
    EvaluateSettings how = small_model();
    EXPECT_TRUE(evaluate_evreal(dataset, how).notes.empty());
    how.lookahead = 2;
    const EvaluateReport ahead = evaluate_evreal(dataset, how);
    ASSERT_EQ(ahead.notes.size(), 1U);
    EXPECT_EQ(ahead.notes[0],
              "EVREAL's tables are without lookahead: these numbers saw 2 event windows more");
}

TEST(Evreal, StartsEachSequenceAnew) {
    const fs::path dataset = fresh_folder("ecd_twice");
    write_recording(dataset / "a", .6, .002, .1);
    write_recording(dataset / "b", .6, .002, .1);
    const EvaluateReport report = evaluate_evreal(dataset, small_model());
    EXPECT_EQ(report.sequences[0].scores.raw.mse, report.sequences[1].scores.raw.mse);
}

TEST(Evreal, TakesFoldersAndFilesThatBringImagesAlongByName) {
    const fs::path dataset = fresh_folder("evreal_kinds");
    for (const char* file :
         {"hqf.bag", "mvsec_data.hdf5", "davis.aedat4", "notes.txt", "sheet.png"})
        std::ofstream{dataset / file} << "x";
    for (const char* folder : {"arrays", "ecd", "half", "pictures"})
        fs::create_directories(dataset / folder);
    for (const char* file : {"arrays/events_ts.npy", "ecd/events.txt", "ecd/images.txt",
                             "half/events.txt", "pictures/images.txt"})
        std::ofstream{dataset / file} << "x";
    const std::vector<fs::path> expected{dataset / "arrays", dataset / "davis.aedat4",
                                         dataset / "ecd", dataset / "hqf.bag",
                                         dataset / "mvsec_data.hdf5"};
    EXPECT_EQ(evreal_sequences(dataset), expected);
    EXPECT_EQ(evreal_sequences(dataset / "hqf.bag"), std::vector{dataset / "hqf.bag"});
    EXPECT_THROW(evreal_sequences(dataset / "half"), Error);
    EXPECT_THROW(evreal_sequences(dataset / "notes.txt"), Error);
}

TEST(Evreal, NamesWhatItCannotRead) {
    const fs::path dataset = fresh_folder("nothing");
    EXPECT_THROW(evaluate_evreal(dataset, small_model()), Error);
}

}  // namespace
}  // namespace eventide::test
