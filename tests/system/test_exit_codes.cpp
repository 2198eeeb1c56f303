// Exit codes and words: each kind of trouble has its own, and nothing is written where it should
// not.
#include "tests/system/program_test.h"

#include <filesystem>

namespace eventide::test {
namespace {

class ExitCodes : public ProgramTest {
protected:
    /// Fails with this code, says something with these words, and writes nothing else.
    void expect(int code, const std::vector<std::string>& arguments, const std::string& words,
                ProcessSettings settings = {}) const {
        const Result result = eventide(arguments, std::move(settings));
        std::string line = "eventide";
        for (const std::string& argument : arguments) line += " " + argument;
        EXPECT_EQ(result.exit_code, code) << line << "\n" << result.error;
        EXPECT_NE(result.error.find(words), std::string::npos) << line << "\n" << result.error;
        EXPECT_EQ(result.output, "") << line;
    }
};

TEST_F(ExitCodes, HelpAndVersionAreData) {
    for (const char* flag : {"--help", "--version"}) {
        const Result result = eventide({flag});
        EXPECT_EQ(result.exit_code, 0);
        EXPECT_NE(result.output.find("eventide"), std::string::npos);
        EXPECT_EQ(result.error, "");
    }
    for (const char* command :
         {"run", "info", "convert", "devices", "doctor", "simulate", "evaluate", "bench"}) {
        const Result result = eventide({command, "--help"});
        EXPECT_EQ(result.exit_code, 0);
        EXPECT_NE(result.output.find("Examples:"), std::string::npos) << command;
        EXPECT_EQ(result.output.find("Excludes"), std::string::npos) << command;
    }
}

TEST_F(ExitCodes, TwoIsWrongUsage) {
    expect(2, {"fly"}, "fly");
    expect(2, {"rnu"}, "did you mean run?");
    expect(2, {"run", recording(), "--frm", "5ms"},
           "did you mean --from?; see eventide run --help");
    expect(2, {"run", recording(), "--strict", "--no-strict", "--out", "null"}, "--no-strict");
    expect(2, {"info", recording(), "another"}, "another");
    expect(2, {"run"}, "SOURCE");
    expect(2, {"run", recording()}, "--out");
    expect(2, {"run", recording(), "--fsp", "3", "--out", "null"}, "--fsp");
    expect(2, {"run", recording(), "--fps", "-3", "--out", "null"}, "--fps");
    expect(2, {"run", recording(), "--lookahead", "3", "--out", "null"}, "--lookahead");
    expect(2, {"run", recording(), "--window", "soon", "--out", "null"}, "--window");
    expect(2, {"run", recording(), "--size", "big", "--out", "null"}, "--size");
    expect(2, {"run", recording(), "--roi", "60,0,30x10", "--out", "null"}, "");
    expect(2, {"run", recording(), "--out", "picture.bmp"}, "picture.bmp");
    expect(2, {"run", recording(), "--out", "-", "--out", "gray8:-"}, "standard output");
    expect(2, {"run", recording(), "--out", "a.mp4", "--uncertainty", "alpha"}, "alpha");
    expect(2, {"run", recording(), "--out", "a.mp4", "--video-preset", "quick"}, "quick");
    expect(2, {"run", recording(), "--out", "null", "--from", "2s", "--to", "1s"}, "--to");
    expect(2, {"run", recording(), "--out", "window"}, "display");
    expect(2, {"convert", recording(), "a.xyz"}, "a.xyz");
    expect(2, {"simulate", "--scene", "nowhere", "--out", "a.aedat4"}, "nowhere");
    expect(2, {"evaluate", recording(), "--protocol", "folders"}, "two folders");
}

TEST_F(ExitCodes, TwoIsAlsoAFullFolderWithoutOverwrite) {
    std::filesystem::create_directory(temp_ / "a");
    write_text(temp_ / "a/mine.txt", "x");
    expect(2, {"run", recording(), "--out", "a/"}, "--overwrite");
    write_text(temp_ / "a.mp4", "x");
    expect(2, {"run", recording(), "--out", "a.mp4"}, "--overwrite");
    EXPECT_EQ(eventide({"run", recording(), "--out", "a/", "--overwrite"}).exit_code, 0);
    EXPECT_EQ(read_text(temp_ / "a/mine.txt"), "x");
}

TEST_F(ExitCodes, ThreeIsAnInputThatIsNotWhatItSays) {
    expect(3, {"run", "nothing.aedat4", "--out", "a/"}, "nothing.aedat4");
    write_text(temp_ / "noise.aedat4", std::string(1000, '\x07'));
    expect(3, {"run", "noise.aedat4", "--out", "a/"}, "noise.aedat4");
    expect(3, {"info", "noise.aedat4"}, "noise.aedat4");
    expect(3, {"convert", "noise.aedat4", "b.txt"}, "noise.aedat4");
    expect(3, {"run", recording(), "--model", "nobody", "--out", "a/"}, "nobody");
    write_text(temp_ / "bad.safetensors", "not a model");
    expect(3, {"run", recording(), "--model", "bad.safetensors", "--out", "a/"}, "bad.safetensors");
    write_text(temp_ / "huge.raw", "% evt 3.0\n% geometry 65535x65535\n% end\n");
    expect(3, {"run", "huge.raw", "--out", "a/"}, "huge.raw: expected a sensor of at most");
    write_text(temp_ / "a.gz", "\x1F\x8B\x08");
    expect(3, {"run", "a.gz", "--out", "a/"}, "zcat");
    EXPECT_FALSE(std::filesystem::exists(temp_ / "a")) << "a wrong input leaves nothing behind";
    EXPECT_FALSE(std::filesystem::exists(temp_ / "b.txt"));
}

TEST_F(ExitCodes, FourIsACameraThatIsNotThere) {
    expect(4, {"run", "davis:nobody", "--out", "null"}, "nobody");
}

TEST_F(ExitCodes, OneIsFailureWhileRunning) {
    expect(1, {"run", recording(), "--out", "gray8:/dev/full"}, "/dev/full");
    expect(1, {"run", recording(), "--out", "/proc/nowhere/"}, "/proc/nowhere");
}

TEST_F(ExitCodes, FiveIsDamageUnderStrictOnly) {
    std::string text = "16 16\n";
    for (int i = 0; i < 100; ++i) text += "0." + std::to_string(100'000 + i) + " 1 2 1\n";
    write_text(temp_ / "damaged.txt", text + "0.2 99 99 1\n");
    EXPECT_EQ(eventide({"run", "damaged.txt", "--out", "null"}).exit_code, 0);
    const Result strict = eventide({"run", "damaged.txt", "--out", "null", "--strict"});
    EXPECT_EQ(strict.exit_code, 5) << strict.error;
    EXPECT_NE(strict.error.find("out_of_range: 1"), std::string::npos);
    EXPECT_EQ(eventide({"info", "damaged.txt", "--strict"}).exit_code, 5);
    EXPECT_EQ(eventide({"run", recording(), "--out", "null", "--strict"}).exit_code, 0);
}

TEST_F(ExitCodes, QuietIsSilentWhenAllIsWell) {
    const Result result = eventide({"run", recording(), "--out", "a/", "--quiet"});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.error + result.output, "");
}

TEST_F(ExitCodes, AConfigurationFileIsHeldToItsKeys) {
    write_text(temp_ / "c.toml", "[run]\nfps = 50\nfsp = 3\n");
    expect(2, {"run", recording(), "--out", "null", "--config", "c.toml"}, "c.toml:3");
    write_text(temp_ / "c.toml", "[run]\nfps = 50\nout = \"a/\"\n");
    EXPECT_EQ(eventide({"run", recording(), "--config", "c.toml"}).exit_code, 0);
    EXPECT_NEAR(double(column(temp_ / "a/timestamps.csv", 0).size()), 20, 1);
    const Result shown =
        eventide({"run", "--config", "c.toml", "--size", "2x", "--print-config"},
                 {.environment = {{"EVENTIDE_RUN_LOOKAHEAD", "1"}, {"EVENTIDE_RUN_FPS", "60"}}});
    EXPECT_EQ(shown.exit_code, 0) << shown.error;
    for (const char* part : {"# flag --size", "# environment EVENTIDE_RUN_FPS", "fps = \"60\"",
                             "# file c.toml:3", "# default"})
        EXPECT_NE(shown.output.find(part), std::string::npos) << part << "\n" << shown.output;
}

TEST_F(ExitCodes, TheMovingLineIsForTerminalsThatAreNotToldToBeQuiet) {
    const std::vector<std::string> run{"run", "sim:demo?size=64x48", "--duration", "700ms", "--out",
                                       "null"};
    EXPECT_NE(eventide(run, {.error_to_terminal = true}).error.find(" events/s  window"),
              std::string::npos);
    EXPECT_EQ(eventide(run).error.find('\r'), std::string::npos);
    std::vector<std::string> quiet = run;
    quiet.push_back("--quiet");
    EXPECT_EQ(eventide(quiet, {.error_to_terminal = true}).error, "");
}

TEST_F(ExitCodes, ColourIsForTerminalsAndNoColorIsRespected) {
    const auto complain = [&](ProcessSettings settings) {
        return eventide({"run", "nothing.raw", "--out", "null"}, std::move(settings)).error;
    };
    const std::string escape = "\033[";
    EXPECT_EQ(complain({}).find(escape), std::string::npos);
    EXPECT_NE(
        complain({.environment = {{"TERM", "xterm"}}, .error_to_terminal = true}).find(escape),
        std::string::npos);
    EXPECT_EQ(
        complain({.environment = {{"TERM", "xterm"}, {"NO_COLOR", "1"}}, .error_to_terminal = true})
            .find(escape),
        std::string::npos);
}

}  // namespace
}  // namespace eventide::test
