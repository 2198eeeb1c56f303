// No output is an input or another output, by whatever name.
#include "tests/system/outputs_test.h"

#include <filesystem>

namespace eventide::test {
namespace {

namespace fs = std::filesystem;

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
    expect_refused({"evaluate", "rec.aedat4", "--json", "-", "--calibrated", "-"},
                   "--calibrated -: --json - has standard output; expected another file");
    expect_refused({"evaluate", "rec.aedat4", "--json", "-", "--csv", "/dev/stdout"},
                   "--csv /dev/stdout: is the same file as --json -");
    expect_refused({"evaluate", "rec.aedat4", "--csv", "-", "--json", "/dev/fd/1"},
                   "--csv -: is the same file as --json /dev/fd/1");
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

TEST_F(Outputs, NoTableIsWhereStandardOutputIsForAnOutput) {
    ASSERT_EQ(
        eventide({"evaluate", "rec.aedat4", "--calibrated", "cal", "--json", "scores"}).exit_code,
        0);
    for (const char* standard_output : {"-", "/dev/stdout", "/dev/fd/1"}) {
        EXPECT_EQ(eventide({"evaluate", "rec.aedat4", "--calibrated", standard_output}).output,
                  read_text(temp_ / "cal"))
            << standard_output;
        EXPECT_EQ(eventide({"evaluate", "rec.aedat4", "--json", standard_output}).output,
                  read_text(temp_ / "scores"))
            << standard_output;
    }
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

}  // namespace
}  // namespace eventide::test
