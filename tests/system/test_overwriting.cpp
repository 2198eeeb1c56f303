// What is replaced, and what stays where that is not asked for or does not succeed.
#include "tests/system/outputs_test.h"

#include <filesystem>

namespace eventide::test {
namespace {

namespace fs = std::filesystem;

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
