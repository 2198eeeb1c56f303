// eventide run, as a user runs it: what is in the files afterwards.
#include "tests/support/flickering_light.h"
#include "tests/system/program_test.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace eventide::test {
namespace {

using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::json;

class Run : public ProgramTest {};

/// All files below a folder with their bytes, run.json left out: it tells the time it took.
std::map<std::string, std::string> contents(const std::filesystem::path& folder) {
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator{folder})
        if (entry.is_regular_file() && entry.path().filename() != "run.json")
            files[std::filesystem::relative(entry.path(), folder).string()] =
                read_text(entry.path());
    return files;
}

TEST_F(Run, SaysThatLightFlickers) {
    std::ofstream text{temp_ / "lamp.txt"};
    text << "32 24\n";
    for (const Event& event : lamp_events({.hz = 100, .seconds = 1}))
        text << to_us(event.t) << "e-6 " << event.x << ' ' << event.y << ' '
             << (event.polarity == Polarity::on) << '\n';
    text.close();
    const Result result = eventide(
        {"run", "lamp.txt", "--realtime", "--speed", "1", "--out", "null", "--stats", "s.jsonl"});
    ASSERT_EQ(result.exit_code, 0) << result.error;
    EXPECT_THAT(result.error, HasSubstr("light flickers at 100 Hz"));
    EXPECT_THAT(result.error, HasSubstr("light flickered at 100 Hz: "));
    std::istringstream stats{read_text(temp_ / "s.jsonl")};
    Json last;
    for (std::string line; std::getline(stats, line);) last = Json::parse(line);
    EXPECT_NEAR(last["flicker_hz"], 100, 2);
    EXPECT_GT(last["flicker_events"], 100);
}

TEST_F(Run, WritesAFolderAVideoAndASheetInOneGo) {
    const Result result = eventide({"run", recording(), "--fps", "100", "--out", "frames/", "--out",
                                    "video.mp4", "--out", "contact-sheet:sheet.png",
                                    "--uncertainty", "side", "--stats", "stats.jsonl"});
    ASSERT_EQ(result.exit_code, 0) << result.error;
    EXPECT_EQ(result.output, "") << "data go where they were sent, and messages to standard error";
    EXPECT_NE(result.error.find("frames"), std::string::npos);

    const auto times = column(temp_ / "frames/timestamps.csv", 2);
    ASSERT_GE(times.size(), 38U);
    std::vector<long long> since_first;
    for (const long long t : times) since_first.push_back(t - times.front());
    EXPECT_EQ(packet_times(temp_ / "video.mp4"), since_first);
    EXPECT_EQ(since_first[1], 10'000);
    EXPECT_EQ(probe(temp_ / "video.mp4", "width,height"), "128,48\n");
    EXPECT_TRUE(std::filesystem::exists(temp_ / "frames/uncertainty/unc_0000000037.tiff"));
    EXPECT_TRUE(std::filesystem::exists(temp_ / "sheet.png"));

    const Json json = Json::parse(read_text(temp_ / "frames/run.json"));
    EXPECT_EQ(json["arguments"][0], "run");
    EXPECT_EQ(json["source"]["width"], 64);
    EXPECT_EQ(json["counters"]["frames"], times.size());
    EXPECT_EQ(json["settings"]["fps"], "100");

    std::ifstream stats{temp_ / "stats.jsonl"};
    Json last;
    for (std::string line; std::getline(stats, line);) last = Json::parse(line);
    EXPECT_EQ(last["final"], true);
    EXPECT_EQ(last["frames"], times.size());
    EXPECT_EQ(last["images"], 11);
}

TEST_F(Run, OnOneThreadGivesTheSameFilesBitForBit) {
    ASSERT_EQ(eventide({"run", recording(), "--fps", "60", "--out", "a/"}).exit_code, 0);
    ASSERT_EQ(eventide({"run", recording(), "--fps", "60", "--sequential", "--threads", "1",
                        "--out", "b/"})
                  .exit_code,
              0);
    EXPECT_EQ(contents(temp_ / "a"), contents(temp_ / "b"));
}

TEST_F(Run, SlowMotionIsSlowInFilesAndPipes) {
    const Result result = eventide({"run", recording(), "--duration", "200ms", "--slow", "10",
                                    "--fps", "25", "--out", "a.mp4", "--out", "a.y4m"});
    ASSERT_EQ(result.exit_code, 0) << result.error;
    const auto times = packet_times(temp_ / "a.mp4");
    ASSERT_EQ(times.size(), 51U) << "25 a second of 2 s, and the first";
    EXPECT_EQ(times[1], 40'000);
    EXPECT_EQ(times.back(), 2'000'000);
    EXPECT_EQ(probe(temp_ / "a.y4m", "r_frame_rate,nb_read_frames"), "25/1,51\n");
}

TEST_F(Run, RawNumbersHaveTheSizeThatIsDocumented) {
    const Result result = eventide({"run", recording(), "--fps", "20", "--size", "33x17", "--out",
                                    "grayf32:raw", "--uncertainty", "separate", "--out", "a/"});
    ASSERT_EQ(result.exit_code, 0) << result.error;
    const std::size_t frames = column(temp_ / "a/timestamps.csv", 0).size();
    EXPECT_EQ(std::filesystem::file_size(temp_ / "raw"), frames * 2 * 33 * 17 * 4);
}

TEST_F(Run, SaysThatImagesHaveAnotherClockAndRendersTheEvents) {
    ASSERT_EQ(eventide({"convert", recording(), "a/"}).exit_code, 0);
    const Result made = in_shell(
        "awk '{ printf \"%.6f %s\\n\", $1 + 1633953690, $2 }' a/images.txt > later && "
        "mv later a/images.txt && eventide convert a b.aedat4");
    ASSERT_EQ(made.exit_code, 0) << made.error;
    const Result of_events =
        eventide({"run", recording(), "--frames", "ignore", "--fps", "100", "--out", "events/"});
    ASSERT_EQ(of_events.exit_code, 0) << of_events.error;
    const auto times = column(temp_ / "events/timestamps.csv", 2);
    for (const std::string source : {"a", "b.aedat4"}) {
        const Result result =
            eventide({"run", source, "--fps", "100", "--out", source + ".frames/"});
        ASSERT_EQ(result.exit_code, 0) << result.error;
        EXPECT_THAT(result.error, HasSubstr("expected one clock for images and events, found them "
                                            "at least 1633953689 s apart"));
        const auto found = column(temp_ / (source + ".frames/timestamps.csv"), 2);
        EXPECT_NEAR(double(found.size()), double(times.size()), 1) << source;
    }
}

TEST_F(Run, KeepsItsStateInAFileOfThisModelOnly) {
    ASSERT_EQ(eventide({"run", recording(), "--out", "null", "--state-out", "state"}).exit_code, 0);
    const std::vector<std::string> common{"run", recording(), "--to", "60ms", "--out"};
    const auto with = [&](std::vector<std::string> more) {
        std::vector<std::string> all = common;
        all.insert(all.end(), more.begin(), more.end());
        return eventide(all);
    };
    EXPECT_EQ(with({"a/"}).exit_code, 0);
    EXPECT_EQ(with({"b/", "--state-in", "state"}).exit_code, 0);
    EXPECT_NE(contents(temp_ / "a"), contents(temp_ / "b"));
    const Result wrong = with({"c/", "--state-in", "state", "--model", wrong_model()});
    EXPECT_EQ(wrong.exit_code, 3) << wrong.error;
    EXPECT_FALSE(std::filesystem::exists(temp_ / "c")) << "a wrong input leaves nothing behind";
    std::filesystem::resize_file(temp_ / "state", 1000);
    const Result cut = with({"d/", "--state-in", "state"});
    EXPECT_EQ(cut.exit_code, 3) << cut.error;
    EXPECT_NE(cut.error.find("state: tensor 'h.0'"), std::string::npos) << cut.error;
    EXPECT_FALSE(std::filesystem::exists(temp_ / "d"));
}

TEST_F(Run, RecordsWhatItReads) {
    ASSERT_EQ(eventide({"run", recording(), "--out", "null", "--record", "again.aedat4"}).exit_code,
              0);
    const auto info = [&](const std::string& file) {
        return Json::parse(eventide({"info", file, "--json"}).output);
    };
    const Json original = info(recording()), again = info(temp_ / "again.aedat4");
    for (const char* key : {"events", "on", "first_us", "last_us", "frames", "width"})
        EXPECT_EQ(original[key], again[key]) << key;
}

TEST_F(Run, LookAndHotPixelsAreAppliedWhenAskedFor) {
    const Result result =
        eventide({"run", recording(), "--auto-hdr", "--unsharp", "0.3", "--flip", "both", "--crop",
                  "4", "--hot-pixels", "learn", "--events", "--out", "a/"});
    ASSERT_EQ(result.exit_code, 0) << result.error;
    EXPECT_TRUE(std::filesystem::exists(temp_ / "a/events/events_0000000000.png"));
    EXPECT_EQ(probe(temp_ / "a/frames/frame_0000000000.png", "width,height"), "56,40\n");
}

TEST_F(Run, AFolderHasNoEventsBecauseAContactSheetShowsThem) {
    const Result result = eventide(
        {"run", recording(), "--to", "60ms", "--out", "a/", "--out", "contact-sheet:sheet.png"});
    ASSERT_EQ(result.exit_code, 0) << result.error;
    EXPECT_TRUE(std::filesystem::exists(temp_ / "a/frames/frame_0000000000.png"));
    EXPECT_FALSE(std::filesystem::exists(temp_ / "a/events"));
}

TEST_F(Run, APageThatOthersReachWantsAToken) {
    for (const auto& [address, wants] : {std::pair{"127.0.0.1", false}, {"0.0.0.0", true}}) {
        const Result result = eventide({"run", recording(), "--duration", "20ms", "--speed", "max",
                                        "--out", std::string{"http:"} + address + ":0"});
        if (result.error.find("built without") != std::string::npos) GTEST_SKIP() << result.error;
        EXPECT_EQ(result.exit_code, 0) << result.error;
        EXPECT_NE(result.error.find("live page: http://"), std::string::npos) << result.error;
        EXPECT_EQ(result.error.find("?token=") != std::string::npos, wants) << result.error;
    }
}

TEST_F(Run, TheRecordOfARunHasNoToken) {
    const std::vector<std::string> run{"run",   recording(), "--to",  "20ms", "--speed",    "max",
                                       "--out", "http:0",    "--out", "a/",   "--overwrite"};
    for (const std::vector<std::string>& token :
         {std::vector<std::string>{"--http-token", "sesame"}, {"--http-token=sesame"}}) {
        std::vector<std::string> arguments = run;
        arguments.insert(arguments.end(), token.begin(), token.end());
        const Result result = eventide(arguments);
        ASSERT_EQ(result.exit_code, 0) << result.error;
        const std::string record = read_text(temp_ / "a/run.json");
        EXPECT_EQ(record.find("sesame"), std::string::npos) << record;
        EXPECT_EQ(Json::parse(record)["settings"]["http_token"], "(given)");
    }
}

TEST_F(Run, RendersOneRegionOnly) {
    ASSERT_EQ(eventide({"run", recording(), "--size", "2x", "--roi", "10,20,30x16", "--out", "a/",
                        "--to", "60ms"})
                  .exit_code,
              0);
    EXPECT_EQ(probe(temp_ / "a/frames/frame_0000000000.png", "width,height"), "30,16\n");
}

/// They bring a hundred others each: 46 and 20 MB, and the time to load them.
TEST_F(Run, LoadsLibrariesForImageFilesWindowsAndVideosOnlyWhereTheyAreAskedFor) {
    const auto loads = [&](const std::string& out) {
        return eventide({"run", recording(), "--to", "60ms", "--out", out},
                        {.environment = {{"LD_DEBUG", "files"}}})
            .error;
    };
    const std::string none = loads("null"), folder = loads("a/"), video = loads("v.mp4");
    EXPECT_THAT(none, HasSubstr("libopencv_core"));
    EXPECT_THAT(none, Not(HasSubstr("libopencv_imgcodecs")));
    EXPECT_THAT(none, Not(HasSubstr("libopencv_highgui")));
    EXPECT_THAT(folder, HasSubstr("libopencv_imgcodecs"));
    EXPECT_THAT(none, Not(HasSubstr("libav")));
    EXPECT_THAT(folder, Not(HasSubstr("libopencv_highgui")));
    EXPECT_THAT(video, HasSubstr("libavformat"));
    EXPECT_THAT(video, Not(HasSubstr("libopencv_imgcodecs")));
}

TEST_F(Run, TakesASimulationInPlaceOfACamera) {
    const Result result = eventide({"run", "sim:demo?size=64x48&seconds=0.2&speed=max", "--fps",
                                    "50", "--latency", "none", "--out", "a/"});
    ASSERT_EQ(result.exit_code, 0) << result.error;
    EXPECT_GE(column(temp_ / "a/timestamps.csv", 0).size(), 9U);
}

TEST_F(Run, AVideoWhoseTimesAreRoundedSaysSo) {
    for (const char* file : {"a.mkv", "B.MKV"}) {
        const Result result = eventide({"run", recording(), "--duration", "50ms", "--out", file});
        EXPECT_EQ(result.exit_code, 0);
        EXPECT_NE(result.error.find(std::string{file} + ": Matroska rounds times to 1 ms"),
                  std::string::npos)
            << result.error;
    }
    for (const auto& [fps, words] : {std::pair{"frame", true}, {"30", false}}) {
        const Result result = eventide({"run", recording(), "--duration", "50ms", "--overwrite",
                                        "--fps", fps, "--out", "c.avi"});
        EXPECT_EQ(result.exit_code, 0);
        EXPECT_EQ(result.error.find("c.avi: frames come at no constant rate") != std::string::npos,
                  words)
            << result.error;
    }
}

}  // namespace
}  // namespace eventide::test
