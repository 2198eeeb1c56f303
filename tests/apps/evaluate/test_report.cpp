// What is written about an evaluation: table, CSV and JSON.
#include "apps/evaluate/csv_field.h"
#include "apps/evaluate/evaluate.h"
#include "tests/apps/evaluate/recordings.h"
#include "tests/apps/evaluate/small_model.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <algorithm>

namespace eventide::test {
namespace {

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
