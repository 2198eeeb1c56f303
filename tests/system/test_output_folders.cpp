// Folders that are written to: what is replaced in them is an earlier run's alone.
#include "src/io/file_lock.h"
#include "tests/system/outputs_test.h"

#include <filesystem>

namespace eventide::test {
namespace {

namespace fs = std::filesystem;

TEST_F(Outputs, AnOutputInAFolderThatIsNotThereIsRefused) {
    for (const auto& command : {std::vector<std::string>{"evaluate", "rec.aedat4", "--json", "x"},
                                {"evaluate", "rec.aedat4", "--calibrated", "x"},
                                {"convert", "rec.aedat4", "x.txt"},
                                {"simulate", "--out", "x.txt"},
                                {"run", "rec.aedat4", "--out", "x.mp4"},
                                {"run", "rec.aedat4", "--out", "gray8:x"},
                                {"run", "rec.aedat4", "--out", "contact-sheet:x.png"},
                                {"run", "rec.aedat4", "--out", "null", "--record", "x.txt"},
                                {"run", "rec.aedat4", "--out", "null", "--events-out", "x.txt"},
                                {"run", "rec.aedat4", "--out", "null", "--stats", "x"},
                                {"run", "rec.aedat4", "--out", "null", "--state-out", "x"}}) {
        std::vector<std::string> words = command;
        words.back().insert(words.back().find('x'), "nodir/");
        expect_refused(words, words.back(), "expected a folder that exists");
    }
    EXPECT_EQ(eventide({"run", "rec.aedat4", "--out", "contact-sheet:new/x.png", "--out", "null",
                        "--out", "new/", "--stats", "new/stats", "--state-out", "new/state"})
                  .exit_code,
              0);
    for (const char* file : {"x.png", "stats", "state", "timestamps.csv"})
        EXPECT_TRUE(fs::exists(temp_.path() / "new" / file)) << file;
}

/// What another part of the same command is refused for leaves an earlier run as it was.
TEST_F(Outputs, AnEarlierRunStaysWhereTheNextCannotStart) {
    ASSERT_EQ(eventide({"run", "rec.aedat4", "--out", "k/"}).exit_code, 0);
    const auto before = files();
    const auto fails = [&](std::vector<std::string> more) {
        more.insert(more.begin(), {"run", "rec.aedat4", "--out", "k/", "--overwrite"});
        EXPECT_NE(eventide(more).exit_code, 0) << more.back();
        EXPECT_TRUE(files() == before) << more.back();
    };
    fails({"--crop", "100"});
    fails({"--roi", "0,0,999x9"});
    fails({"--latency", "1s"});
    fails({"--out", "x.gif", "--fps", "300"});
    fails({"--out", "nodir/x.mp4"});
    fails({"--stats", "nodir/x"});
    fails({"--out", "v4l2:/dev/video99"});
    write_text(temp_ / "none.txt", "64 48\n");
    const auto with_none = files();
    eventide({"run", "none.txt", "--out", "k/", "--overwrite"});
    EXPECT_TRUE(files() == with_none) << "there is no frame to put in its place";
}

TEST_F(Outputs, AFolderLosesAnEarlierRunAndNothingElse) {
    fs::create_directories(temp_ / "a/frames");
    write_text(temp_ / "a/frames/frame_0000000001.png", "mine");
    write_text(temp_ / "a/timestamps.txt", "mine");
    expect_refused({"run", "rec.aedat4", "--out", "a/", "--overwrite"}, "a/timestamps.txt",
                   "expected a file that an earlier run wrote");
    fs::remove(temp_ / "a/timestamps.txt");
    expect_refused({"run", "rec.aedat4", "--out", "a/", "--overwrite"},
                   "a/frames/frame_0000000001.png");
    fs::rename(temp_ / "a/frames/frame_0000000001.png", temp_ / "a/frames/holiday.png");
    const std::vector<std::string> again{"run",   "rec.aedat4", "--fps",      "50",
                                         "--out", "a/",         "--overwrite"};
    ASSERT_EQ(eventide(again).exit_code, 0);
    ASSERT_EQ(eventide(again).exit_code, 0) << "an earlier run of ours is replaced";
    EXPECT_EQ(read_text(temp_ / "a/frames/holiday.png"), "mine");
    write_text(temp_ / "a/frames/frame_0000000500.png", "mine");
    expect_refused(again, "a/frames/frame_0000000500.png");
}

TEST_F(Outputs, AFolderOfStatesLosesAnEarlierRunsAndNothingElse) {
    const auto states_at = [](const std::vector<std::string>& times) {
        std::vector<std::string> words{"run",          "rec.aedat4", "--frames",   "ignore",
                                       "--states-out", "s/",         "--overwrite"};
        for (const std::string& time : times) words.insert(words.end(), {"--states-at", time});
        return words;
    };
    ASSERT_EQ(eventide(states_at({"100ms", "200ms"})).exit_code, 0);
    EXPECT_TRUE(fs::exists(temp_ / "s/state_000001.safetensors"));
    ASSERT_EQ(eventide(states_at({"150ms"})).exit_code, 0);
    EXPECT_FALSE(fs::exists(temp_ / "s/state_000001.safetensors")) << "it was of another run";
    ASSERT_EQ(eventide(states_at({"100ms", "200ms"})).exit_code, 0);
    std::vector<std::string> from_it = states_at({"300ms"});
    from_it.insert(from_it.end(), {"--state-in", "s/state_000001.safetensors"});
    expect_refused(from_it, "s/state_000001.safetensors");
    const std::string second = read_text(temp_ / "s/state_000001.safetensors");
    EXPECT_EQ(eventide(states_at({"9s"})).exit_code, 2);
    EXPECT_EQ(read_text(temp_ / "s/state_000001.safetensors"), second) << "no state took its place";
    write_text(temp_ / "s/state_000001.safetensors", "mine");
    expect_refused(states_at({"150ms"}), "s/state_000001.safetensors", "earlier run's states");
    const Result late = eventide({"run", "rec.aedat4", "--frames", "ignore", "--states-out", "t/",
                                  "--states-at", "100ms", "--states-at", "9s"});
    EXPECT_EQ(late.exit_code, 2);
    EXPECT_NE(late.error.find("--states-at 9s: expected a time before"), std::string::npos);
}

TEST_F(Outputs, TwoRunsDoNotFillOneFolder) {
    FolderLock of_another_run;
    of_another_run.take(temp_ / "s");
    for (std::vector<std::string> command :
         {std::vector<std::string>{"run", "rec.aedat4", "--frames", "ignore", "--states-at",
                                   "100ms", "--states-out"},
          {"evaluate", "rec.aedat4", "--figure", "events", "--plots"},
          {"bench", "--plots"},
          {"bench", "--report"},
          {"stress", "--soak", "0.1", "--models", "default", "--plots"}}) {
        command.insert(command.end(), {"s/", "--overwrite"});
        expect_refused(command, "s/: expected a folder that no other run writes to");
    }
}

TEST_F(Outputs, AFolderForWhatWasNotMadeIsNotLeftBehind) {
    EXPECT_NE(eventide({"evaluate", "rec.aedat4", "--from", "9s", "--figure", "events", "--plots",
                        "new/"})
                  .exit_code,
              0);
    EXPECT_FALSE(fs::exists(temp_ / "new"));
}

TEST_F(Outputs, ASimulatedFolderIsReplacedByAnotherOnly) {
    const std::vector<std::string> simulate{"simulate", "--seconds",   "0.1",  "--size",
                                            "32x24",    "--overwrite", "--out"};
    const auto into = [&](const char* folder) {
        auto all = simulate;
        all.push_back(folder);
        return all;
    };
    ASSERT_EQ(eventide(into("a/")).exit_code, 0);
    ASSERT_EQ(eventide(into("a/")).exit_code, 0);
    expect_refused({"run", "rec.aedat4", "--overwrite", "--out", "a/"}, "a/run.json");
    fs::create_directories(temp_ / "ecd/images");
    write_text(temp_ / "ecd/events.txt", "0.1 1 1 1\n");
    expect_refused(into("ecd/"), "ecd/events.txt");
    write_text(temp_ / "ecd/images.txt", "");
    for (const char* source : {"ecd", "ecd/events.txt"})
        expect_refused({"run", source, "--input-size", "8x8", "--out", "ecd/", "--overwrite"},
                       "--out ecd/: is the same folder as", "SOURCE ecd");
}

TEST_F(Outputs, OtherOutputsMayLieInAFolderOfFrames) {
    const std::vector<std::string> run{
        "run",          "rec.aedat4",   "--out",    "a/video.mp4",
        "--out",        "a/",           "--stats",  "a/stats.jsonl",
        "--state-out",  "a/state",      "--record", "a/all.aedat4",
        "--events-out", "a/events.txt", "--out",    "contact-sheet:a/sheet.png"};
    ASSERT_EQ(eventide(run).exit_code, 0);
    auto again = run;
    again.push_back("--overwrite");
    ASSERT_EQ(eventide(again).exit_code, 0);
    for (const char* name :
         {"stats.jsonl", "state", "sheet.png", "run.json", "video.mp4", "all.aedat4", "events.txt"})
        EXPECT_TRUE(fs::exists(temp_ / ("a/" + std::string{name}))) << name;
}

}  // namespace
}  // namespace eventide::test
