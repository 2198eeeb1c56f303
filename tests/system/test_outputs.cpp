// What a command was not told to write it does not touch: inputs, other outputs, files of the user.
#include "tests/system/program_test.h"

#include <filesystem>

namespace eventide::test {
namespace {

namespace fs = std::filesystem;

class Outputs : public ProgramTest {
protected:
    Outputs() {
        fs::copy_file(recording(), temp_ / "rec.aedat4");
        fs::copy_file(model(), temp_ / "model.safetensors");
        fs::create_symlink("rec.aedat4", temp_ / "link.aedat4");
        fs::create_hard_link(temp_ / "rec.aedat4", temp_ / "hard.aedat4");
        write_text(temp_ / "c.toml", "[run]\nfps = 20\n");
    }

    /// Ends with exit code 2 and both names, and leaves every file in the folder as it was.
    void expect_refused(const std::vector<std::string>& arguments, const std::string& one,
                        const std::string& other = {}) const {
        const auto before = files();
        std::string line = "eventide";
        for (const std::string& argument : arguments) line += " " + argument;
        const Result result = eventide(arguments);
        EXPECT_EQ(result.exit_code, 2) << line << "\n" << result.error;
        for (const std::string& words : {one, other})
            EXPECT_NE(result.error.find(words), std::string::npos) << line << "\n" << result.error;
        EXPECT_TRUE(files() == before) << line;
    }

    /// All files with their bytes.
    std::map<std::string, std::string> files() const {
        std::map<std::string, std::string> all;
        for (const auto& entry : fs::recursive_directory_iterator{temp_.path()})
            all[entry.path()] = entry.is_regular_file() ? read_text(entry.path()) : "";
        return all;
    }
};

TEST_F(Outputs, AnInputIsNoOutputByWhateverName) {
    for (const char* name : {"rec.aedat4", "link.aedat4", "hard.aedat4", "./rec.aedat4"}) {
        const std::string again = name;
        expect_refused({"convert", "rec.aedat4", again, "--overwrite"}, "TO " + again,
                       "FROM rec.aedat4");
        const auto refused = [&](const char* option, const std::string& value) {
            expect_refused({"run", "rec.aedat4", "--out", "null", "--overwrite", option, value},
                           std::string{option} + " " + value, "SOURCE rec.aedat4");
        };
        refused("--record", again);
        refused("--out", "y4m:" + again);
        refused("--out", "gray8:" + again);
        refused("--stats", again);
        refused("--state-out", again);
        expect_refused({"evaluate", "rec.aedat4", "--overwrite", "--json", again},
                       "--json " + again, "INPUT rec.aedat4");
        expect_refused({"evaluate", again, "--overwrite", "--csv", "rec.aedat4"},
                       "--csv rec.aedat4", "INPUT " + again);
    }
}

TEST_F(Outputs, ModelsStatesAndSettingsAreInputsToo) {
    write_text(temp_ / "hot.txt", "3,4\n");
    for (const char* command : {"run", "convert"}) {
        std::vector<std::string> line{command, "rec.aedat4", "--filter", "hot-pixels:hot.txt",
                                      "--overwrite"};
        if (line[0] == "run") line.insert(line.end(), {"--out", "null", "--events-out"});
        line.emplace_back("hot.txt");
        expect_refused(line, "hot.txt", "--filter hot.txt");
    }
    const std::vector<std::string> run{"run", "rec.aedat4", "--out", "null", "--overwrite"};
    const auto refused = [&](std::vector<std::string> more, const std::string& input) {
        more.insert(more.begin(), run.begin(), run.end());
        expect_refused(more, more.back(), input);
    };
    refused({"--model", "model.safetensors", "--state-out", "model.safetensors"}, "--model");
    refused({"--config", "c.toml", "--stats", "c.toml"}, "--config");
    refused({"--state-in", "model.safetensors", "--record", "model.safetensors"}, "--record");
    refused({"--camera", "c.toml", "--stats", "c.toml"}, "--camera");
    refused({"--hot-pixels", "c.toml", "--stats", "c.toml"}, "--hot-pixels");
    expect_refused({"evaluate", "rec.aedat4", "--model", "model.safetensors", "--overwrite",
                    "--calibrated", "model.safetensors"},
                   "--calibrated", "--model");
    for (const char* command : {"bench", "stress"})
        expect_refused({command, "--models", "model.safetensors", "--overwrite", "--json",
                        "model.safetensors"},
                       "--json", "--models");
}

TEST_F(Outputs, TwoOutputsAreNotOneFile) {
    const auto refused = [&](std::vector<std::string> more) {
        more.insert(more.begin(), {"run", "rec.aedat4", "--overwrite"});
        expect_refused(more, more.back(), "of its own");
    };
    refused({"--out", "x.mp4", "--out", "x.mp4"});
    refused({"--out", "x.mp4", "--out", "y4m:./x.mp4"});
    refused({"--out", "a/", "--out", "a/"});
    refused({"--out", "a/", "--out", "contact-sheet:a/frames/frame_0000000000.png"});
    refused({"--out", "a/", "--stats", "a/timestamps.csv"});
    refused({"--out", "x.mp4", "--uncertainty", "separate", "--out", "x.sigma.mp4"});
    refused({"--out", "null", "--record", "x.aedat4", "--stats", "x.aedat4"});
    // Also where standard output is a pipe, as it is here: their bytes would mix.
    expect_refused({"run", "rec.aedat4", "--out", "gray8:-", "--events-out", "text:-"},
                   "--events-out -", "--out -");
    expect_refused({"run", "rec.aedat4", "--out", "gray8:-", "--out", "-"}, "--out -",
                   "standard output");
    expect_refused({"run", "rec.aedat4", "--out", "-", "--events-out", "text:/dev/stdout"},
                   "--events-out", "--out -");
    expect_refused({"evaluate", "rec.aedat4", "--json", "x", "--csv", "x"}, "--json x", "--csv x");
    expect_refused({"simulate", "--out", "a/", "--truth", "a/"}, "--out a/", "--truth a/");
}

TEST_F(Outputs, StandardInputAndOutputAreFilesToo) {
    const auto shell = [&](const std::string& command) {
        return run({"bash", "-c", "PATH=$(dirname " EVENTIDE_PROGRAM "):$PATH; " + command},
                   {.folder = temp_.path().string()});
    };
    const auto before = files();
    EXPECT_EQ(shell("eventide convert - rec.aedat4 --overwrite < rec.aedat4").exit_code, 2);
    EXPECT_EQ(shell("eventide convert rec.aedat4 - --to-format text >> rec.aedat4").exit_code, 2);
    EXPECT_TRUE(files() == before);
}

TEST_F(Outputs, NothingIsReplacedUnasked) {
    for (const char* option : {"--stats", "--state-out", "--record"}) {
        write_text(temp_ / "mine.txt", "precious");
        expect_refused({"run", "rec.aedat4", "--out", "null", option, "mine.txt"}, "mine.txt",
                       "--overwrite");
    }
    for (const char* option : {"--json", "--csv", "--frame-csv", "--calibrated"})
        expect_refused({"evaluate", "rec.aedat4", option, "mine.txt"}, "mine.txt", "--overwrite");
    expect_refused({"bench", "--json", "mine.txt"}, "mine.txt", "--overwrite");
    expect_refused({"stress", "--json", "mine.txt"}, "mine.txt", "--overwrite");
    for (const char* file : {"bench.csv", "reliability.csv"}) write_text(temp_ / file, "precious");
    expect_refused({"bench", "--plots", "."}, "bench.csv", "--overwrite");
    expect_refused({"evaluate", "rec.aedat4", "--figure", "reliability", "--plots", "."},
                   "reliability.csv", "--overwrite");
}

TEST_F(Outputs, WhatWasAskedForIsReplaced) {
    for (const char* name : {"stats", "state", "scores"}) write_text(temp_ / name, "old");
    EXPECT_EQ(eventide({"run", "rec.aedat4", "--out", "null", "--stats", "stats", "--state-out",
                        "state", "--overwrite"})
                  .exit_code,
              0);
    EXPECT_EQ(eventide({"evaluate", "rec.aedat4", "--json", "scores", "--overwrite"}).exit_code, 0);
    EXPECT_EQ(read_text(temp_ / "stats").front(), '{');
    EXPECT_EQ(read_text(temp_ / "scores").front(), '{');
    EXPECT_EQ(eventide({"run", "rec.aedat4", "--out", "null", "--state-in", "state"}).exit_code, 0);
}

TEST_F(Outputs, TexturesOfASimulationAreInputs) {
    fs::create_directory(temp_ / "textures");
    write_text(temp_ / "textures/a.png", "a photograph");
    expect_refused({"run", "sim:demo?textures=textures", "--out", "null", "--overwrite", "--stats",
                    "textures/a.png"},
                   "--stats textures/a.png", "SOURCE textures");
}

TEST_F(Outputs, WhatAKilledConversionLeftIsNoInputOfTheOneThatRemovesIt) {
    fs::create_directory(temp_ / "d");
    write_text(temp_ / "d/events.txt.part", "64 48\n0.1 1 2 1\n");
    write_text(temp_ / "d/run.json",
               R"({"program": "eventide", "files": {"images": 0}, "single": ["events.txt"],)"
               R"( "finished": false})");
    expect_refused({"convert", "d/events.txt.part", "d/", "--overwrite"}, "TO d/events.txt.part",
                   "FROM d/events.txt.part");
}

TEST_F(Outputs, APlotIsAnOutputToo) {
    expect_refused({"evaluate", "rec.aedat4", "--overwrite", "--figure", "sigma", "--plots", ".",
                    "--csv", "sigma_error.csv"},
                   "--plots sigma_error.csv", "--csv sigma_error.csv");
}

TEST_F(Outputs, StandardOutputAndStandardErrorAreOutputsToo) {
    const Result table = in_shell("eventide evaluate rec.aedat4 --json scores > scores");
    EXPECT_EQ(table.exit_code, 2);
    EXPECT_NE(table.error.find("--json scores: is the same file as standard output"),
              std::string::npos)
        << table.error;
    EXPECT_EQ(in_shell("eventide run rec.aedat4 --out null --stats log 2> log").exit_code, 2);
    EXPECT_NE(read_text(temp_ / "log").find("--stats log: is the same file as standard error"),
              std::string::npos);
    EXPECT_EQ(
        in_shell("eventide run rec.aedat4 --duration 20ms --out null --stats /dev/fd/2 2> log")
            .exit_code,
        0);
}

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

TEST_F(Outputs, WorkIsNotDoneForWhatCannotBeWrittenInTheEnd) {
    const std::string long_name(252, 'x');
    for (const auto& command :
         {std::vector<std::string>{"convert", "rec.aedat4", long_name + ".txt"},
          {"run", "rec.aedat4", "--out", "null", "--state-out", long_name + ".state"},
          {"run", "rec.aedat4", "--out", "contact-sheet:" + long_name + ".png"}}) {
        const Result result = eventide(command);
        EXPECT_EQ(result.exit_code, 1);
        EXPECT_NE(result.error.find(": cannot be created: File name too long"), std::string::npos)
            << result.error;
        EXPECT_EQ(result.error.find("info: "), std::string::npos) << "before any work";
    }
    for (const char* folder : {"--report", "--plots"})
        expect_refused({"bench", "--sizes", "32x24", folder, "rec.aedat4"},
                       std::string{folder} + " rec.aedat4", "expected a folder, found a file");
    expect_refused({"evaluate", "rec.aedat4", "--figure", "sigma", "--plots", "rec.aedat4/x"},
                   "--plots rec.aedat4/x", "expected a folder, found a file");
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

TEST_F(Outputs, OneFileIsWholeWhereAnotherFails) {
    fs::create_symlink("/dev/full", temp_ / "full.aedat4");
    const Result result = eventide({"run", "rec.aedat4", "--out", "null", "--record", "full.aedat4",
                                    "--events-out", "events.aedat4"});
    EXPECT_EQ(result.exit_code, 1) << result.error;
    EXPECT_EQ(eventide({"info", "events.aedat4"}).exit_code, 0);
}

TEST_F(Outputs, AFileThatCannotBeWrittenWholeLeavesTheOldOne) {
    const auto limited = [&](const std::string& arguments) {
        return run({"bash", "-c", "ulimit -f 1; exec " EVENTIDE_PROGRAM " " + arguments},
                   {.environment = {{"EVENTIDE_MODELS", fs::path{model()}.parent_path()}},
                    .folder = temp_.path().string()});
    };
    for (const char* name : {"old.txt", "old.safetensors", "old.png"})
        write_text(temp_ / name, "old");
    const auto before = files();
    for (const std::string arguments :
         {"convert rec.aedat4 old.txt --overwrite",
          "simulate --seconds 0.1 --out old.txt --overwrite",
          "run rec.aedat4 --out null --state-out old.safetensors --overwrite",
          "run rec.aedat4 --out contact-sheet:old.png --overwrite",
          "evaluate rec.aedat4 --calibrated old.safetensors --overwrite"}) {
        const Result result = limited(arguments);
        EXPECT_EQ(result.exit_code, 1) << arguments << "\n" << result.error;
        EXPECT_NE(result.error.find("old."), std::string::npos) << result.error;
        EXPECT_TRUE(files() == before) << arguments;
    }
}

}  // namespace
}  // namespace eventide::test
