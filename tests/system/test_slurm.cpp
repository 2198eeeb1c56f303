// scripts/slurm/ without Slurm: tasks by hand, as an array job would call them.
#include "tests/system/program_test.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <string>

namespace eventide::test {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

class Slurm : public ProgramTest {
protected:
    Result script(const std::string& name, std::vector<std::string> arguments,
                  std::map<std::string, std::string> environment = {}) const {
        arguments.insert(arguments.begin(),
                         std::string{EVENTIDE_SOURCE_DIR} + "/scripts/slurm/" + name);
        environment["EVENTIDE"] = EVENTIDE_PROGRAM;
        environment["EVENTIDE_MODELS"] = fs::path{model()}.parent_path().string();
        return run(arguments,
                   {.environment = std::move(environment), .folder = temp_.path().string()});
    }
    void simulate(const std::string& out) const {
        const Result made = eventide(
            {"simulate", "--scene", "demo", "--seconds", "2.2", "--size", "32x24", "--out", out});
        ASSERT_EQ(made.exit_code, 0) << made.error;
    }
    std::vector<std::string> plan(std::vector<std::string> options) const {
        options.insert(options.begin(), "--plan");
        options.insert(options.end(),
                       {"--", "--fps", "20", "--precision", "f32", "--kernels", "own"});
        return options;
    }
    std::string all_of(const std::string& folder) const {
        std::string content;
        std::vector<fs::path> files;
        for (const auto& entry : fs::recursive_directory_iterator{temp_ / folder})
            if (entry.is_regular_file() && entry.path().filename() != "run.json")
                files.push_back(entry.path());
        std::ranges::sort(files);
        for (const fs::path& file : files)
            content += fs::relative(file, temp_ / folder).string() + "\n" + read_text(file);
        return content;
    }
};

TEST_F(Slurm, SegmentsAreJoinedToWhatOneRunWrites) {
    simulate("long.aedat4");
    ASSERT_EQ(eventide({"run", "long.aedat4", "--fps", "20", "--precision", "f32", "--kernels",
                        "own", "--out", "one/"})
                  .exit_code,
              0);
    const Result planned = script("submit.sh", plan({"--segment", "1", "out", "long.aedat4"}));
    ASSERT_EQ(planned.exit_code, 0) << planned.error;
    EXPECT_THAT(planned.error, HasSubstr("3 tasks"));
    for (const char* task : {"2", "0"}) {
        const Result done = script("task.sh", {"out"}, {{"SLURM_ARRAY_TASK_ID", task}});
        ASSERT_EQ(done.exit_code, 0) << done.error;
    }
    const Result early = script("merge.sh", {"out"});
    EXPECT_EQ(early.exit_code, 2);
    EXPECT_THAT(early.error, HasSubstr("not done yet: tasks 1 ("));
    EXPECT_FALSE(fs::exists(temp_ / "out/long"));

    // What a killed task and a killed merge leave is in nobody's way.
    fs::create_directories(temp_ / "out/parts/long.000001.host.1.work/frames");
    fs::create_directories(temp_ / "out/long.1.work/frames");
    ASSERT_EQ(script("task.sh", {"out", "1"}).exit_code, 0);
    const Result again = script("task.sh", {"out", "1"});
    EXPECT_THAT(again.error, HasSubstr("done before"));
    EXPECT_FALSE(fs::exists(temp_ / "out/parts/long.000001.host.1.work"));
    const Result merged = script("merge.sh", {"out"});
    ASSERT_EQ(merged.exit_code, 0) << merged.error;
    const std::string one = all_of("one"), joined = all_of("out/long");
    EXPECT_GT(one.size(), 44U * 1000);
    EXPECT_TRUE(joined == one) << "every frame, sigma and time, bit for bit";
    EXPECT_THAT(script("merge.sh", {"out"}).error, HasSubstr("done before"));
    EXPECT_FALSE(fs::exists(temp_ / "out/long.1.work"));
}

TEST_F(Slurm, ARecordingWhoseClockBeganAnewHasNoSegments) {
    simulate("once.aedat4");
    ASSERT_EQ(eventide({"convert", "once.aedat4", "once.raw"}).exit_code, 0);
    std::ofstream{temp_ / "twice.raw", std::ios::binary} << read_text(temp_ / "once.raw")
                                                         << read_text(temp_ / "once.raw");
    const Result refused = script("submit.sh", plan({"--segment", "1", "out", "twice.raw"}));
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.error, HasSubstr("the clock of twice.raw began anew"));
    EXPECT_EQ(script("submit.sh", plan({"out", "twice.raw"})).exit_code, 0);
}

TEST_F(Slurm, StatesGiveTheSegmentsWhatOneRunRemembered) {
    ASSERT_EQ(eventide({"simulate", "--scene", "demo", "--seconds", "5.2", "--size", "32x24",
                        "--out", "long.aedat4"})
                  .exit_code,
              0);
    const std::vector<std::string> options{"--fps",     "20",  "--precision", "f32",
                                           "--kernels", "own", "--frames",    "ignore"};
    std::vector<std::string> whole{"run", "long.aedat4", "--out", "one/"};
    whole.insert(whole.end(), options.begin(), options.end());
    ASSERT_EQ(eventide(whole).exit_code, 0);
    std::vector<std::string> words{"--plan", "--states",    "--segment", "2",
                                   "out",    "long.aedat4", "--"};
    words.insert(words.end(), options.begin(), options.end());
    const Result planned = script("submit.sh", words);
    ASSERT_EQ(planned.exit_code, 0) << planned.error;
    EXPECT_THAT(script("task.sh", {"out", "1"}).error, HasSubstr("states.sh out makes it"));
    // Another recording's, whose job runs beside this one.
    fs::create_directories(temp_ / "out/states/long.more.host.1.work");
    fs::create_directories(temp_ / "out/states/0.host.1.work");  // and what a killed one left
    const Result states = script("states.sh", {"out"}, {{"SLURM_ARRAY_TASK_ID", "0"}});
    ASSERT_EQ(states.exit_code, 0) << states.error;
    EXPECT_TRUE(fs::exists(temp_ / "out/states/long.more.host.1.work"));
    EXPECT_FALSE(fs::exists(temp_ / "out/states/0.host.1.work"));
    EXPECT_THAT(script("states.sh", {"out", "0"}).error, HasSubstr("nothing to do"));
    for (const char* task : {"2", "0", "1"}) {
        const Result done = script("task.sh", {"out", task});
        ASSERT_EQ(done.exit_code, 0) << done.error;
    }
    ASSERT_EQ(script("merge.sh", {"out"}).exit_code, 0);
    EXPECT_TRUE(all_of("one") == all_of("out/long")) << "every frame, sigma and time, bit for bit";
    EXPECT_THAT(read_text(temp_ / "out/parts/long.000002/run.json"), HasSubstr("state_000001"));
}

TEST_F(Slurm, StatesOfARecordingWithoutImagesNeedNoFurtherOption) {
    ASSERT_EQ(eventide({"simulate", "--scene", "demo", "--seconds", "2.2", "--size", "32x24",
                        "--images-per-second", "0", "--out", "long.aedat4"})
                  .exit_code,
              0);
    const Result planned =
        script("submit.sh", plan({"--states", "--segment", "1", "out", "long.aedat4"}));
    ASSERT_EQ(planned.exit_code, 0) << planned.error;
    const Result states = script("states.sh", {"out", "0"});
    ASSERT_EQ(states.exit_code, 0) << states.error;
    const Result last = script("task.sh", {"out", "2"});
    EXPECT_EQ(last.exit_code, 0) << last.error;
    EXPECT_THAT(read_text(temp_ / "out/parts/long.000002/run.json"), HasSubstr("state_000000"));
}

/// As Ctrl-C would: the run ends properly, and the part is not whole all the same.
TEST_F(Slurm, ATaskThatWasStoppedIsNotDone) {
    simulate("long.aedat4");
    std::vector<std::string> words{"--plan", "out",    "long.aedat4", "--",      "--fps",
                                   "1000",   "--size", "8x",          "--speed", "1"};
    ASSERT_EQ(script("submit.sh", words).exit_code, 0);
    const std::string stopper = temp_ / "stopper";
    write_text(stopper,
               "#!/bin/bash\n\"$PROGRAM\" \"$@\" & run=$!\n"
               "until grep -q , $OUT/*.work/timestamps.csv 2>/dev/null; do :; done\n"
               "kill -INT $run; wait $run\n");
    fs::permissions(stopper, fs::perms::owner_all);
    const Result stopped =
        run({EVENTIDE_SOURCE_DIR "/scripts/slurm/task.sh", "out", "0"},
            {.environment = {{"EVENTIDE", stopper},
                             {"PROGRAM", EVENTIDE_PROGRAM},
                             {"OUT", temp_ / "out/parts"},
                             {"EVENTIDE_MODELS", fs::path{model()}.parent_path().string()}},
             .folder = temp_.path().string()});
    EXPECT_EQ(stopped.exit_code, 2) << stopped.error;
    EXPECT_THAT(stopped.error, HasSubstr("expected a finished run"));
    EXPECT_THAT(script("merge.sh", {"out"}).error, HasSubstr("not done yet: tasks 0 ("));
}

TEST_F(Slurm, OneTaskForEachRecording) {
    simulate("a.aedat4");
    const std::string other = "b \"slow\"";
    fs::copy_file(temp_ / "a.aedat4", temp_ / (other + ".aedat4"));
    ASSERT_EQ(script("submit.sh", plan({"out", "a.aedat4", other + ".aedat4"})).exit_code, 0);
    for (const char* task : {"0", "1"}) ASSERT_EQ(script("task.sh", {"out", task}).exit_code, 0);
    ASSERT_EQ(script("merge.sh", {"out"}).exit_code, 0);
    EXPECT_TRUE(all_of("out/a") == all_of("out/" + other));
    EXPECT_EQ(nlohmann::json::parse(read_text(temp_ / ("out/" + other + "/run.json")))["parts"],
              "parts/" + other + ".*");
    EXPECT_TRUE(all_of("out/a") == all_of("out/parts/a.000000"));
}

TEST_F(Slurm, WhatCannotBeIsNamed) {
    simulate("a.aedat4");
    EXPECT_THAT(script("submit.sh", plan({"out", "none.aedat4"})).error,
                HasSubstr("none.aedat4: no such recording"));
    EXPECT_THAT(script("submit.sh", plan({"--states", "out", "a.aedat4"})).error,
                HasSubstr("--states: expected --segment SECONDS"));
    EXPECT_THAT(script("submit.sh",
                       plan({"--states", "--warmup", "2", "--segment", "1", "out", "a.aedat4"}))
                    .error,
                HasSubstr("expected one of them"));
    EXPECT_THAT(script("submit.sh", plan({"--states", "--segment", "1", "out", "a.aedat4"})).error,
                HasSubstr("expected --frames ignore among the options of run"));
    EXPECT_FALSE(fs::exists(temp_ / "out")) << "a plan that cannot be changed any more";
    EXPECT_EQ(script("submit.sh", plan({"--states", "--segment", "1", "ignoring", "a.aedat4"}),
                     {{"EVENTIDE_RUN_FRAMES", "ignore"}})
                  .exit_code,
              0)
        << "what the environment says holds for eventide run, too";
    EXPECT_THAT(script("submit.sh", plan({"--segment", "1s", "out", "a.aedat4"})).error,
                HasSubstr("--segment: expected whole seconds, found '1s'"));
    EXPECT_THAT(script("submit.sh", {"--plan", "out", "a.aedat4", "--", "--out", "x/"}).error,
                HasSubstr("--out: the tasks set that themselves"));
    EXPECT_THAT(
        script("submit.sh", {"--plan", "out", "a.aedat4", "--", "--states-out", "x/"}).error,
        HasSubstr("--states-out: the tasks set that themselves"));
    EXPECT_THAT(script("submit.sh",
                       {"--plan", "--segment", "1", "out", "a.aedat4", "--", "--stats=all.jsonl"})
                    .error,
                HasSubstr("--stats=all.jsonl: every task would write to the same"));
    EXPECT_FALSE(fs::exists(temp_ / "out"));
    ASSERT_EQ(script("submit.sh", plan({"out", "a.aedat4"})).exit_code, 0);
    EXPECT_EQ(script("submit.sh", plan({"out", "a.aedat4"})).exit_code, 0) << "the same again";
    EXPECT_THAT(script("submit.sh", plan({"--segment", "1", "out", "a.aedat4"})).error,
                HasSubstr("out: holds another plan"));
    EXPECT_THAT(script("task.sh", {"out", "7"}).error,
                HasSubstr("expected task 7, found 1 task\n"));
    EXPECT_THAT(script("task.sh", {"out"}).error, HasSubstr("SLURM_ARRAY_TASK_ID"));
    EXPECT_THAT(script("task.sh", {"out", "x"}).error, HasSubstr("a whole number"));
    for (const char* name : {"task.sh", "states.sh", "merge.sh", "scaling.sh"}) {
        const Result nothing = script(name, {});
        EXPECT_EQ(nothing.exit_code, 2);
        EXPECT_EQ(nothing.error, std::string{name} + ": expected OUT, the folder of a plan\n");
    }
    EXPECT_THAT(script("submit.sh", {"--sbatch"}).error,
                HasSubstr("--sbatch: expected options of sbatch, found none"));
    EXPECT_THAT(script("scaling.sh", {"out", "1", "0"}).error,
                HasSubstr("NODES: expected a whole number above 0, found '0'"));
    EXPECT_THAT(script("merge.sh", {"."}).error, HasSubstr("expected plan.tsv"));
    fs::remove(temp_ / "a.aedat4");
    const Result failed = script("scaling.sh", {"out"});
    EXPECT_EQ(failed.exit_code, 2);
    EXPECT_THAT(failed.error, HasSubstr("a.aedat4: "));
    EXPECT_THAT(failed.error, HasSubstr("task.sh out 0 failed\n"));
}

}  // namespace
}  // namespace eventide::test
