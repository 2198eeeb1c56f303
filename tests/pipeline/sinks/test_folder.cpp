// The folder sink reads back as what went in.
#include "pipeline/sinks/folder.h"
#include "src/core/error.h"
#include "tests/pipeline/sinks/frames.h"
#include "tests/system/process.h"

#include <opencv2/imgcodecs.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace eventide {
namespace {

using test::TempFolder;

TEST(FolderSink, WritesImagesSigmaAndTimesThatReadBack) {
    const TempFolder temp;
    const Frame first = test::ramp_frame(31, 17, 4, test::odd_time(0));
    const Frame second = test::ramp_frame(31, 17, 9, test::odd_time(1));
    FolderSink sink{{.path = temp / "out",
                     .lost = [] { return 7; },
                     .run_json = [] { return R"({"model": "a name"})"; }}};
    sink.write(first);
    sink.write(second);
    sink.close();

    const cv::Mat image =
        cv::imread(temp / "out/frames/frame_0000000001.png", cv::IMREAD_UNCHANGED);
    ASSERT_EQ(image.type(), CV_8UC1);
    for (int y = 0; y < 17; ++y)
        for (int x = 0; x < 31; ++x)
            EXPECT_EQ(int(image.at<std::uint8_t>(y, x)), std::lround(second.intensity(y, x) * 255));

    const cv::Mat sigma =
        cv::imread(temp / "out/uncertainty/unc_0000000000.tiff", cv::IMREAD_UNCHANGED);
    ASSERT_EQ(sigma.type(), CV_32FC1);
    EXPECT_TRUE(
        std::ranges::equal(first.sigma.values(), std::span{sigma.ptr<float>(), sigma.total()}));

    EXPECT_EQ(test::read_text(temp / "out/timestamps.txt"),
              "1633953690.975951\n1633953690.979283\n");
    EXPECT_EQ(test::read_text(temp / "out/timestamps.csv"),
              "frame,index,t_us,window_begin_us,window_end_us,events,lost\n"
              "0,4,1633953690975951,1633953690970951,1633953691020951,104,7\n"
              "1,9,1633953690979283,1633953690974283,1633953691024283,109,7\n");
    const auto record = nlohmann::json::parse(test::read_text(temp / "out/run.json"));
    EXPECT_EQ(record["model"], "a name");
    EXPECT_EQ(record["files"]["frames"], 2);
    EXPECT_EQ(record["files"]["uncertainty"], 2);
}

TEST(FolderSink, RefusesAFolderThatHoldsSomethingAndReplacesOnlyItsOwnFiles) {
    const TempFolder temp;
    {
        FolderSink sink{{.path = temp / "out"}};
        for (int n = 0; n < 3; ++n) sink.write(test::ramp_frame(8, 8, n, test::odd_time(n)));
        sink.close();
    }
    test::write_text(temp / "out/notes.txt", "mine");
    try {
        FolderSink sink{{.path = temp / "out"}};
        FAIL() << "a folder that holds something was taken";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::usage);
        EXPECT_NE(std::string{error.what()}.find("--overwrite"), std::string::npos);
    }
    FolderSink sink{{.path = temp / "out", .overwrite = true}};
    sink.write(test::ramp_frame(8, 8, 0, test::odd_time(0)));
    sink.close();
    EXPECT_TRUE(std::filesystem::exists(temp / "out/frames/frame_0000000000.png"));
    EXPECT_FALSE(std::filesystem::exists(temp / "out/frames/frame_0000000001.png"));
    EXPECT_FALSE(std::filesystem::exists(temp / "out/uncertainty/unc_0000000001.tiff"));
    EXPECT_EQ(test::read_text(temp / "out/notes.txt"), "mine");
}

std::size_t files_in(const std::filesystem::path& folder) {
    return std::size_t(std::distance(std::filesystem::directory_iterator{folder}, {}));
}

std::string refusal(const FolderSettings& settings) {
    try {
        FolderSink sink{settings};
    } catch (const Error& error) {
        return error.kind() == ErrorKind::usage ? error.what() : "not usage";
    }
    return {};
}

TEST(FolderSink, OverwritingLeavesWhatNoRunOfOursWrote) {
    const TempFolder temp;
    const FolderSettings settings{.path = temp / "out", .overwrite = true};
    std::filesystem::create_directories(temp / "out/frames");
    for (const char* name : {"frames/frame_0000000000.png", "timestamps.txt", "run.json"}) {
        test::write_text(temp / ("out/" + std::string{name}), "mine");
        EXPECT_NE(refusal(settings).find(name), std::string::npos) << name;
        EXPECT_EQ(test::read_text(temp / ("out/" + std::string{name})), "mine");
        std::filesystem::remove(temp / ("out/" + std::string{name}));
    }
    for (const char* name : {"frames/frame_7.png", "frames/holiday.png", "notes.txt"})
        test::write_text(temp / ("out/" + std::string{name}), "mine");
    { FolderSink{settings}.write(test::ramp_frame(8, 8, 0, test::odd_time(0))); }
    EXPECT_EQ(test::read_text(temp / "out/frames/holiday.png"), "mine");
    EXPECT_EQ(test::read_text(temp / "out/frames/frame_7.png"), "mine");
    EXPECT_EQ(test::read_text(temp / "out/notes.txt"), "mine");
}

TEST(FolderSink, AFrameBeyondThoseOfTheEarlierRunIsNotItsAndStays) {
    const TempFolder temp;
    const FolderSettings settings{.path = temp / "out", .overwrite = true};
    for (const bool killed : {false, true}) {
        {
            FolderSink sink{settings};
            for (int n = 0; n < 3; ++n) sink.write(test::ramp_frame(8, 8, n, test::odd_time(n)));
            if (!killed) sink.close();
        }
        // A killed run may have been about to write one more than it lists.
        const std::string name = killed ? "frame_0000000004.png" : "frame_0000000003.png";
        const std::string mine = temp / ("out/frames/" + name);
        test::write_text(mine, "mine");
        EXPECT_NE(refusal(settings).find(name), std::string::npos) << killed;
        EXPECT_EQ(test::read_text(mine), "mine");
        std::filesystem::remove(mine);
    }
}

TEST(FolderSink, ARunThatWasKilledCanBeReplaced) {
    const TempFolder temp;
    const FolderSettings settings{.path = temp / "out", .overwrite = true};
    {
        FolderSink killed{settings};  // without close(), the record says that it did not end
        for (int n = 0; n < 3; ++n) killed.write(test::ramp_frame(8, 8, n, test::odd_time(n)));
    }
    test::write_text(temp / "out/frames/frame_0000000003.png.part", "half of the frame in work");
    { FolderSink{settings}.write(test::ramp_frame(8, 8, 0, test::odd_time(0))); }
    EXPECT_EQ(files_in(temp / "out/frames"), 1U);
}

TEST(FolderSink, AFolderThatOnlyAnEarlierRunFilledGoesWithIt) {
    const TempFolder temp;
    FolderSettings settings{.path = temp / "out", .overwrite = true, .events = true};
    const auto run = [&settings] {
        Frame frame = test::ramp_frame(8, 8, 0, test::odd_time(0));
        frame.event_preview = Array2<float>{8, 8};
        FolderSink sink{settings};
        sink.write(frame);
        sink.close();
    };
    run();
    ASSERT_TRUE(std::filesystem::exists(temp / "out/events"));
    settings.events = false;
    run();
    EXPECT_FALSE(std::filesystem::exists(temp / "out/events"));
    EXPECT_EQ(files_in(temp / "out/frames"), 1U);
    // One with something else in it stays, and so does a link to a folder elsewhere.
    settings.events = true;
    run();
    test::write_text(temp / "out/events/notes.txt", "mine");
    std::filesystem::rename(temp / "out/frames", temp / "elsewhere");
    std::filesystem::create_directory_symlink(temp / "elsewhere", temp / "out/frames");
    settings.events = false;
    run();
    EXPECT_EQ(files_in(temp / "out/events"), 1U);
    EXPECT_EQ(files_in(temp / "elsewhere"), 1U);
}

/// Another sink, or the run itself, may refuse to start after this one did; and a run may have no
/// frame.
TEST(FolderSink, AnEarlierRunStaysUntilTheFirstFrame) {
    const TempFolder temp;
    const FolderSettings settings{.path = temp / "out", .overwrite = true};
    {
        FolderSink earlier{settings};
        for (int n = 0; n < 2; ++n) earlier.write(test::ramp_frame(8, 8, n, test::odd_time(n)));
        earlier.close();
    }
    const std::string record = test::read_text(temp / "out/run.json");
    { const FolderSink never_begun{settings}; }
    FolderSink{settings}.close();
    EXPECT_EQ(files_in(temp / "out/frames"), 2U);
    EXPECT_EQ(test::read_text(temp / "out/run.json"), record);
    EXPECT_TRUE(std::filesystem::exists(temp / "out/timestamps.txt"));
    FolderSink{settings}.write(test::ramp_frame(8, 8, 0, test::odd_time(0)));
    EXPECT_EQ(files_in(temp / "out/frames"), 1U);
    EXPECT_EQ(test::read_text(temp / "out/timestamps.txt").find('\n'),
              test::read_text(temp / "out/timestamps.txt").size() - 1);
}

TEST(FolderSink, TwoRunsDoNotMixTheirFrames) {
    const TempFolder temp;
    const std::string expected = "expected a folder that no other run writes to";
    FolderSettings settings{.path = temp / "out"};
    FolderSink first{settings};
    EXPECT_THAT(refusal(settings), testing::HasSubstr(expected)) << "as yet without a frame";
    first.write(test::ramp_frame(8, 8, 0, test::odd_time(0)));
    settings.overwrite = true;
    EXPECT_THAT(refusal(settings), testing::HasSubstr(expected));
    first.write(test::ramp_frame(8, 8, 1, test::odd_time(1)));
    first.close();
    EXPECT_EQ(files_in(temp / "out/frames"), 2U);
}

TEST(FolderSink, ANewFolderIsNotLeftBehindByWhatNeverBegan) {
    const TempFolder temp;
    { const FolderSink never_begun{{.path = temp / "out"}}; }
    EXPECT_FALSE(std::filesystem::exists(temp / "out"));
    FolderSink{{.path = temp / "out"}}.close();
    EXPECT_TRUE(std::filesystem::exists(temp / "out/run.json")) << "a run without frames is a run";
}

TEST(FolderSink, ARunOfAnEarlierVersionCanBeReplaced) {
    const TempFolder temp;
    std::filesystem::create_directories(temp / "out/frames");
    test::write_text(temp / "out/run.json", R"({"program": "eventide 0.1.0", "counters": {}})");
    test::write_text(temp / "out/timestamps.csv", "frame,index\n0,0\n1,1\n");
    for (const char* n : {"0", "1"})
        test::write_text(temp / ("out/frames/frame_000000000" + std::string{n} + ".png"), "old");
    FolderSink{{.path = temp / "out", .overwrite = true}}.write(
        test::ramp_frame(8, 8, 0, test::odd_time(0)));
    EXPECT_EQ(files_in(temp / "out/frames"), 1U);
}

TEST(FolderSink, ARecordOfBracketsAloneTakesNoStack) {
    const TempFolder temp;
    std::filesystem::create_directories(temp / "out/frames");
    constexpr int kDeep = 200'000;
    test::write_text(temp / "out/run.json",
                     R"({"program": "eventide", "files": {"frames": 1, "x": )" +
                         std::string(kDeep, '[') + std::string(kDeep, ']') +
                         "}, \"finished\": true}");
    test::write_text(temp / "out/frames/frame_0000000000.png", "old");
    FolderSink{{.path = temp / "out", .overwrite = true}}.write(
        test::ramp_frame(8, 8, 0, test::odd_time(0)));
    EXPECT_NE(test::read_text(temp / "out/frames/frame_0000000000.png"), "old");
}

TEST(FolderSink, NegativeTimesKeepTheirSign) {
    const TempFolder temp;
    FolderSink sink{{.path = temp / "out"}};
    sink.write(test::ramp_frame(8, 8, 0, from_us(-1)));
    sink.close();
    EXPECT_EQ(test::read_text(temp / "out/timestamps.txt"), "-0.000001\n");
}

TEST(FolderSink, WritesEventsWhereTheyAreAskedForAndNotBecauseAnotherSinkWantsThem) {
    const TempFolder temp;
    Frame frame = test::ramp_frame(8, 8, 0, test::odd_time(0));
    frame.event_preview = Array2<float>{8, 8};
    for (const bool asked : {false, true}) {
        const std::string name = asked ? "with" : "without";
        FolderSink sink{{.path = temp / name, .events = asked}};
        sink.write(frame);
        sink.close();
        EXPECT_EQ(std::filesystem::exists(temp / (name + "/events/events_0000000000.png")), asked);
        EXPECT_EQ(std::filesystem::exists(temp / (name + "/events")), asked);
        const auto record = nlohmann::json::parse(test::read_text(temp / (name + "/run.json")));
        EXPECT_EQ(record["files"]["events"], asked ? 1 : 0);
    }
}

TEST(FolderSink, LeavesSigmaOutWhenAsked) {
    const TempFolder temp;
    FolderSink sink{{.path = temp / "out", .uncertainty = Uncertainty::none}};
    sink.write(test::ramp_frame(8, 8, 0, test::odd_time(0)));
    sink.close();
    EXPECT_FALSE(std::filesystem::exists(temp / "out/uncertainty"));
}

TEST(FolderSink, SaysWhyItCannotStart) {
    const TempFolder temp;
    test::write_text(temp / "file", "x");
    EXPECT_THROW((FolderSink{{.path = temp / "file"}}), Error);
    EXPECT_THROW((FolderSink{{.path = "/proc/nowhere/out"}}), Error);
}

}  // namespace
}  // namespace eventide
