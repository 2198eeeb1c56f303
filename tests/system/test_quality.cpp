// The quality of a run: chosen, pinned, and said where programs read it.
#include "tests/system/program_test.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <sched.h>

#include <filesystem>
#include <sstream>
#include <string>

namespace eventide::test {
namespace {

using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::json;

constexpr const char* kCamera = "sim:demo?size=64x48&seconds=0.4";

class Quality : public ProgramTest {
protected:
    Json run_json(const std::string& folder) {
        return Json::parse(read_text(temp_ / (folder + "/run.json")));
    }
    ProcessSettings with_cache() const {
        return {.environment = {{"XDG_CACHE_HOME", temp_ / "cache"}}};
    }
};

TEST_F(Quality, ACamerasIsChosenByAProfileThatIsKept) {
    const std::vector<std::string> run{"run", kCamera,   "--budget",    "1s",         "--out",
                                       "a/",  "--stats", "stats.jsonl", "--overwrite"};
    const Result first = eventide(run, with_cache());
    ASSERT_EQ(first.exit_code, 0) << first.error;
    EXPECT_THAT(first.error, HasSubstr("measuring what this processor does with default at 64x48"));
    EXPECT_THAT(first.error, HasSubstr("quality: default, "));
    const Json quality = run_json("a").at("quality");
    EXPECT_EQ(quality.at("mode"), "auto");
    EXPECT_EQ(quality.at("model"), "default");
    EXPECT_THAT((std::vector<std::string>{"f32", "bf16"}),
                testing::Contains(quality.at("precision").get<std::string>()));
    EXPECT_EQ(quality.at("scale"), 1);
    EXPECT_EQ(quality.at("frames_per_second"), 30);
    EXPECT_EQ(quality.at("min_window_ms"), 2);
    EXPECT_EQ(run_json("a").at("settings").at("window"), "auto,20ms,2ms") << "of a model of 20 ms";
    EXPECT_EQ(quality.at("budget"), "1s");
    EXPECT_EQ(quality.at("holds"), true);
    EXPECT_EQ(quality.at("measured"), true);
    EXPECT_EQ(run_json("a").at("settings").at("precision"), quality.at("precision"));
    EXPECT_TRUE(std::filesystem::exists(quality.at("profile").get<std::string>()));
    std::istringstream lines{read_text(temp_ / "stats.jsonl")};
    Json last;
    for (std::string line; std::getline(lines, line);) last = Json::parse(line);
    EXPECT_EQ(last.at("quality").at("mode"), "auto");
    EXPECT_TRUE(last.at("quality").at("load").contains("encode"));

    const Result second = eventide(run, with_cache());
    ASSERT_EQ(second.exit_code, 0) << second.error;
    EXPECT_THAT(second.error, Not(HasSubstr("measuring")));
    EXPECT_EQ(run_json("a").at("quality").at("measured"), false);
}

TEST_F(Quality, FixedChangesNothing) {
    const Result result = eventide(
        {"run", kCamera, "--quality", "fixed", "--budget", "1us", "--out", "a/"}, with_cache());
    ASSERT_EQ(result.exit_code, 0) << result.error;
    EXPECT_THAT(result.error, HasSubstr("--budget 1us: nothing is chosen by it"));
    const Json quality = run_json("a").at("quality");
    EXPECT_EQ(quality.at("mode"), "fixed");
    EXPECT_EQ(quality.at("model"), "default");
    EXPECT_EQ(quality.at("precision"), "auto");
    EXPECT_TRUE(quality.at("min_window_ms").is_null());
    EXPECT_EQ(run_json("a").at("settings").at("window"), "auto");
    EXPECT_EQ(quality.at("scale"), 1);
    EXPECT_EQ(quality.at("frames_per_second"), 30);
    EXPECT_FALSE(std::filesystem::exists(temp_ / "cache")) << "nothing was measured";
    EXPECT_EQ(run_json("a").at("settings").at("size"), "1x");
}

TEST_F(Quality, ABudgetThatIsTooSmallGivesTheLeastAndAWarning) {
    const Result result = eventide(
        {"run", kCamera, "--model", model(), "--budget", "1us", "--out", "a/"}, with_cache());
    ASSERT_EQ(result.exit_code, 0) << result.error;
    EXPECT_THAT(result.error, HasSubstr("the pace cannot be held with what is left open"));
    const Json quality = run_json("a").at("quality");
    EXPECT_EQ(quality.at("holds"), false);
    EXPECT_EQ(quality.at("frames_per_second"), 7.5);
    const double scale = quality.at("scale");
    EXPECT_EQ(probe(temp_ / "a/frames/frame_0000000000.png", "width,height"),
              scale == 1 ? "64,48\n" : "21,16\n");
}

TEST_F(Quality, WhatWasGivenStays) {
    const Result result =
        eventide({"run", kCamera, "--model", model(), "--precision", "f32", "--fps", "50", "--size",
                  "2x", "--budget", "1us", "--out", "a/"},
                 with_cache());
    ASSERT_EQ(result.exit_code, 0) << result.error;
    EXPECT_THAT(result.error, HasSubstr("the pace cannot be held"));
    const Json quality = run_json("a").at("quality");
    EXPECT_EQ(quality.at("model"), model());
    EXPECT_EQ(quality.at("precision"), "f32");
    EXPECT_EQ(quality.at("scale"), 2);
    EXPECT_EQ(quality.at("frames_per_second"), 50);
    EXPECT_EQ(quality.at("changes"), 0);
}

TEST_F(Quality, EventWindowsAreOnlyChosenWhereNoneWereAskedFor) {
    for (const std::vector<std::string>& given : {std::vector<std::string>{"--window", "model"},
                                                  {"--window", "20ms"},
                                                  {"--fps", "frame"}}) {
        std::vector<std::string> run{"run",   kCamera, "--model",    model(),
                                     "--out", "a/",    "--overwrite"};
        run.insert(run.end(), given.begin(), given.end());
        const Result result = eventide(run, with_cache());
        ASSERT_EQ(result.exit_code, 0) << result.error;
        EXPECT_TRUE(run_json("a").at("quality").at("min_window_ms").is_null()) << given[1];
    }
}

TEST_F(Quality, WindowsBetweenImagesKeepAFrameEach) {
    for (const char* window : {"aps", "aps,200ms"}) {
        const Result result = eventide({"run", recording(), "--realtime", "--window", window,
                                        "--duration", "100ms", "--out", "null"},
                                       with_cache());
        ASSERT_EQ(result.exit_code, 0) << result.error;
        EXPECT_THAT(result.error, HasSubstr("1x a frame per event window")) << window;
    }
}

TEST_F(Quality, CountsTheProcessorsThatTheProcessMayUse) {
    cpu_set_t usable;
    ASSERT_EQ(sched_getaffinity(0, sizeof usable, &usable), 0);
    int first = 0;
    while (!CPU_ISSET(first, &usable)) ++first;
    const Result result =
        test::run({"taskset", "-c", std::to_string(first), EVENTIDE_PROGRAM, "run", recording(),
                   "--model", model(), "--realtime", "--duration", "100ms", "--out", temp_ / "a/"},
                  with_cache());
    ASSERT_EQ(result.exit_code, 0) << result.error;
    const Json quality = run_json("a").at("quality");
    EXPECT_EQ(quality.at("threads"), 1);
    EXPECT_LE(quality.at("affordable"), 1);
}

TEST_F(Quality, WorksWithoutAHome) {
    const Result result = eventide({"run", kCamera, "--budget", "100%", "--out", "a/"},
                                   {.environment = {{"XDG_CACHE_HOME", ""}, {"HOME", ""}}});
    ASSERT_EQ(result.exit_code, 0) << result.error;
    EXPECT_TRUE(run_json("a").at("quality").at("profile").is_null());
}

TEST_F(Quality, ARecordingIsPacedAsACameraWhereThatIsAskedFor) {
    const Result plain = eventide({"run", recording(), "--out", "a/"}, with_cache());
    ASSERT_EQ(plain.exit_code, 0) << plain.error;
    EXPECT_EQ(run_json("a").at("quality").at("mode"), "fixed");
    const Result paced = eventide({"run", recording(), "--realtime", "--out", "b/"}, with_cache());
    ASSERT_EQ(paced.exit_code, 0) << paced.error;
    EXPECT_EQ(run_json("b").at("quality").at("mode"), "auto");
    EXPECT_GE(run_json("b").at("counters").at("elapsed_s"), 0.3) << "of 0.4 s";
    EXPECT_EQ(run_json("b").at("counters").at("skipped_frames"), 0);
}

TEST_F(Quality, SaysWhereABudgetChoosesNothing) {
    const Result plain = eventide({"run", recording(), "--realtime", "--engine", "plain",
                                   "--budget", "50%", "--out", "null"});
    EXPECT_EQ(plain.exit_code, 0) << plain.error;
    EXPECT_THAT(plain.error, HasSubstr("nothing is chosen by it with --engine plain"));
}

TEST_F(Quality, WithoutAPaceThereIsNothingToChooseBy) {
    const Result budget = eventide({"run", recording(), "--budget", "8ms", "--out", "null"});
    EXPECT_EQ(budget.exit_code, 2);
    EXPECT_THAT(budget.error, HasSubstr("--realtime gives it one"));
    const Result pace =
        eventide({"run", recording(), "--realtime", "--speed", "max", "--out", "null"});
    EXPECT_EQ(pace.exit_code, 2);
    EXPECT_THAT(pace.error, HasSubstr("found --speed max"));
    const Result own = eventide({"run", kCamera, "--speed", "0.1", "--out", "null"});
    EXPECT_EQ(own.exit_code, 2);
    EXPECT_THAT(own.error, HasSubstr("--speed 0.1: expected a recording"));
}

}  // namespace
}  // namespace eventide::test
