// Exit codes and words: each kind of trouble has its own, and nothing is written where it should
// not.
#include "tests/system/program_test.h"

#include <algorithm>
#include <csignal>
#include <filesystem>

namespace eventide::test {
namespace {

namespace fs = std::filesystem;
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

class ExitCodes : public ProgramTest {
protected:
    /// "recording" and "model.safetensors" are the shared ones.
    Result in_shell(const std::string& script) const {
        std::error_code there_already;
        fs::create_symlink(recording(), temp_ / "recording", there_already);
        fs::create_symlink(model(), temp_ / "model.safetensors", there_already);
        return run(
            {"bash", "-o", "pipefail", "-c",
             "PATH=" + fs::path{EVENTIDE_PROGRAM}.parent_path().string() + ":$PATH; " + script},
            {.environment = {{"EVENTIDE_MODELS", fs::path{model()}.parent_path()}},
             .folder = temp_.path().string()});
    }

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
    for (const char* command : {"run", "info", "convert", "devices", "doctor", "simulate",
                                "evaluate", "bench", "stress"}) {
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

TEST_F(ExitCodes, TwoIsAPartOfARecordingThatIsNotThere) {
    expect(2, {"run", recording(), "--from", "100s", "--out", "a/"}, "--from 100s: expected a");
    expect(2, {"run", recording(), "--from", "@99999999999", "--out", "a/"}, "--from @99999999999");
    expect(2, {"run", recording(), "--to", "@-5", "--out", "a/"}, "--to: expected a time after");
    std::string text = "16 16\n";
    for (int i = 0; i < 100; ++i) text += "0." + std::to_string(100'000 + i) + " 1 2 1\n";
    write_text(temp_ / "no_images.txt", text);
    expect(2, {"run", "no_images.txt", "--window", "aps", "--out", "a/"}, "reference images");
    expect(2, {"run", "no_images.txt", "--camera", "a.toml", "--out", "a/"}, "a camera as SOURCE");
    EXPECT_FALSE(std::filesystem::exists(temp_ / "a")) << "nothing is left behind";
    const Result aps = eventide({"run", recording(), "--window", "aps", "--out", "null"});
    EXPECT_EQ(aps.exit_code, 0) << aps.error;
}

TEST_F(ExitCodes, ThreeIsSilenceWithoutEnd) {
    std::string text;
    for (int i = 0; i < 100; ++i) text += "1633953690." + std::to_string(100'000 + i) + " 1 2 1\n";
    write_text(temp_ / "first_wrong.txt", "16 16\n0 1 1 1\n" + text);
    const Result one = eventide({"run", "first_wrong.txt", "--out", "null"});
    EXPECT_EQ(one.exit_code, 0) << one.error;
    EXPECT_NE(one.error.find("bad_record: 1"), std::string::npos) << one.error;
    write_text(temp_ / "epoch.txt", "16 16\n" + text);
    expect(3, {"run", "epoch.txt", "--from", "@0", "--out", "null"}, "--allow-silence");
}

TEST_F(ExitCodes, ADeliberateEndIsNoDamage) {
    std::string text = "16 16\n";
    for (int i = 0; i < 100'000; ++i)
        text += std::to_string(1'000'000 + 10 * i) + " 1 2 1 a_long_line_that_a_chunk_ends_in\n";
    write_text(temp_ / "long.txt", text);
    const Result cut =
        eventide({"run", "long.txt", "--duration", "30ms", "--out", "null", "--strict"});
    EXPECT_EQ(cut.exit_code, 0) << cut.error;
}

TEST_F(ExitCodes, EventsLeftOutForTheirTimesAreSaidByEveryCommand) {
    std::string text = "16 16\n";
    for (int i = 0; i < 1000; ++i)
        text += std::to_string(1'000'000 + 500 * i - (i % 3 == 2 ? 250'000 : 0)) + " 1 2 1\n";
    write_text(temp_ / "mixed.txt", text);
    for (const std::vector<std::string>& command : {std::vector<std::string>{"info", "mixed.txt"},
                                                    {"run", "mixed.txt", "--out", "null"},
                                                    {"convert", "mixed.txt", "mixed.aedat4"}}) {
        const Result result = eventide(command);
        EXPECT_EQ(result.exit_code, 0);
        EXPECT_NE(result.error.find("events already read; a larger --reorder"), std::string::npos)
            << command[0] << "\n"
            << result.error;
    }
    EXPECT_EQ(eventide({"info", "mixed.txt", "--reorder", "1s", "--strict"}).exit_code, 0);
}

/// With so much address space.
Result with_memory(int mebibytes, const std::vector<std::string>& arguments,
                   const std::string& folder) {
    std::vector<std::string> all{"bash", "-c", "ulimit -v $0 && exec \"$@\"",
                                 std::to_string(mebibytes * 1024), EVENTIDE_PROGRAM};
    all.insert(all.end(), arguments.begin(), arguments.end());
    ProcessSettings settings;
    settings.folder = folder;
    return run(all, std::move(settings));
}

TEST_F(ExitCodes, OneIsTooLittleMemoryAndItIsSaidBeforeTheFirstFrame) {
    if (kSanitized) GTEST_SKIP() << "sanitizers take all the address space there is";
    write_text(temp_ / "large.raw", "% evt 3.0\n% geometry 4096x4096\n% end\n");
    const std::string folder = temp_.path().string();
    const Result large =
        with_memory(3000, {"run", "large.raw", "--model", model(), "--out", "a/"}, folder);
    EXPECT_EQ(large.exit_code, 1) << large.error;
    EXPECT_NE(large.error.find("for a sensor of 4096x4096 wants at least"), std::string::npos)
        << large.error;
    EXPECT_FALSE(std::filesystem::exists(temp_ / "a"));
}

/// The shipped network at a real sensor's size: libraries that make code and threads are in it.
/// With less than they need to be loaded, one of them aborts before main().
TEST_F(ExitCodes, WithWhateverMemoryARunNeitherHangsNorCrashes) {
    if (kSanitized) GTEST_SKIP() << "sanitizers take all the address space there is";
    write_text(temp_ / "real.raw", "% evt 3.0\n% geometry 346x260\n% end\n");
    for (int mebibytes = 450; mebibytes <= 700; mebibytes += 25) {
        const Result result =
            with_memory(mebibytes,
                        {"run", "real.raw", "--model",
                         EVENTIDE_SOURCE_DIR "/config/models/default.safetensors", "--out", "null"},
                        temp_.path().string());
        EXPECT_NE(result.exit_code, 128 + SIGSEGV) << mebibytes << " MiB: " << result.error;
    }
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
    expect(1, {"run", recording(), "--out", "null", "--stats", "/dev/full"}, "/dev/full");
    std::filesystem::create_symlink("/dev/full", temp_ / "full.bin");
    expect(1, {"run", recording(), "--out", "null", "--record", "full.bin"}, "full.bin");
}

TEST_F(ExitCodes, OneIsStandardOutputThatCannotBeWritten) {
    for (const char* command :
         {"info recording", "info model.safetensors", "devices --json", "doctor",
          "run --print-config", "simulate --list", "evaluate recording --json -",
          "bench --seconds 0.2 --sizes 16x16", "stress --quick --cases one-event --models default",
          "--help", "run --help", "--version", "--default-config"}) {
        const Result full = in_shell(std::string{"eventide "} + command + " > /dev/full");
        EXPECT_EQ(full.exit_code, 1) << command << "\n" << full.error;
        EXPECT_NE(full.error.find("standard output: cannot be written"), std::string::npos)
            << command << "\n"
            << full.error;
        EXPECT_EQ(in_shell(std::string{"eventide "} + command + " | true").exit_code, 0)
            << command << ": a reader that goes away is no error";
    }
}

TEST_F(ExitCodes, OneIsAFileThatMayNotGrow) {
    for (const char* command :
         {"run recording --out a.mp4", "run recording --out a/", "run recording --out gray8:a.raw",
          "run recording --out null --record a.aedat4", "convert recording c.aedat4",
          "simulate --seconds 0.3 --out b/"}) {
        const Result result = in_shell(std::string{"ulimit -f 1; eventide "} + command);
        EXPECT_EQ(result.exit_code, 1) << command << "\n" << result.error;
        EXPECT_NE(result.error.find("cannot be written"), std::string::npos) << result.error;
    }
}

TEST_F(ExitCodes, OneIsAProcessWithoutFileDescriptors) {
    const auto said = [&](int descriptors, const std::string& command) {
        const Result result = in_shell("ulimit -n " + std::to_string(descriptors) +
                                       "; exec eventide " + command + " --overwrite");
        const bool told = result.error.find("ulimit -n") != std::string::npos;
        EXPECT_TRUE(result.exit_code == 0 || (result.exit_code == 1 && told))
            << descriptors << ", " << command << ": " << result.exit_code << "\n"
            << result.error;
        return told;
    };
    int refused = 0;
    for (int n = 5; n < 16; ++n) {
        refused += said(n, "run recording --out a/ --out b.mp4 --stats s --state-out t");
        refused += said(n, "convert recording c.aedat4");
    }
    EXPECT_GT(refused, 4);
}

TEST_F(ExitCodes, AClosedStandardStreamGetsNoFile) {
    EXPECT_EQ(in_shell("eventide run recording --out gray8:a 2>&- >&-").exit_code, 0);
    EXPECT_EQ(read_text(temp_ / "a").size() % (64 * 48), 0U);
    EXPECT_EQ(in_shell("eventide info recording >&-").exit_code, 1);
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

TEST_F(ExitCodes, SayWhatWasMeantInTheFieldsWords) {
    expect(2, {"run", "metavision:", "--out", "null"}, "unknown source; expected a file");
    expect(2, {"run", recording(), "--out", "gray8:"}, "--out gray8: needs a path");
    expect(2, {"run", recording(), "video.mp4"},
           "unexpected argument 'video.mp4'; did you mean --out?");
    expect(2, {"run", recording(), "--roi", "9999,0,5x5", "--out", "null"},
           "--roi exceeds the frame");
    write_text(temp_ / "empty.raw", "");
    expect(3, {"info", "empty.raw"}, "the file is empty");
    write_text(temp_ / "letters.raw", "letters and nothing else, for a while, which is no format");
    expect(3, {"info", "letters.raw"}, "unrecognised format");
    expect(3, {"run", recording(), "--model", "letters.raw", "--out", "null"}, "not a model file");
    const Result typo =
        eventide({"info", recording()}, {.environment = {{"EVENTIDE_RUN_FPSS", "3"}}});
    EXPECT_NE(typo.error.find("unknown variable EVENTIDE_RUN_FPSS in the environment; did you mean "
                              "EVENTIDE_RUN_FPS?"),
              std::string::npos)
        << typo.error;
    EXPECT_NE(eventide({"convert", recording(), "none.txt", "--from", "@900000000"})
                  .error.find("wrote 0 events"),
              std::string::npos);
}

TEST_F(ExitCodes, AStampWantsARawStream) {
    expect(2, {"run", recording(), "--out", "a.y4m", "--stamp"}, "--stamp: expected a raw stream");
}

TEST_F(ExitCodes, FramesAreNotWrittenToATerminalUnlessItIsForced) {
    const ProcessSettings terminal{.output_to_terminal = true};
    for (const char* sink : {"-", "gray8:-"}) {
        const std::vector<std::string> run{"run", recording(), "--duration", "1ms", "--out", sink};
        expect(2, run, "--force", terminal);
        std::vector<std::string> forced = run;
        forced.push_back("--force");
        const Result result = eventide(forced, terminal);
        EXPECT_EQ(result.exit_code, 0) << result.error;
        EXPECT_NE(result.output, "");
    }
    expect(2, {"convert", recording(), "-", "--to-format", "evt3"}, "--force", terminal);
    const Result text =
        eventide({"convert", recording(), "-", "--to-format", "text", "--to", "1ms"}, terminal);
    EXPECT_EQ(text.exit_code, 0) << "people can read it";
}

/// What stood on the terminal at some time: the line is drawn again after each return.
std::vector<std::string> drawn_lines(const std::string& text) {
    std::vector<std::string> lines;
    std::size_t begin = 0;
    for (std::size_t end = 0; (end = text.find_first_of("\r\n", begin)) != text.npos;
         begin = end + 1)
        lines.push_back(text.substr(begin, std::min(end, text.find("\033[K", begin)) - begin));
    return lines;
}

TEST_F(ExitCodes, TheMovingLineFitsTheTerminalAndIsNotForThoseWhoWantQuiet) {
    const std::vector<std::string> run{"run", "sim:demo?size=64x48", "--duration", "700ms", "--out",
                                       "null"};
    for (const int columns : {40, 80, 200}) {
        const std::string text =
            eventide(run, {.error_to_terminal = true, .terminal_columns = columns}).error;
        bool found = false;
        for (const std::string& line : drawn_lines(text)) {
            const bool moving = line.find(" %  ") != line.npos;
            found = found || moving;
            EXPECT_TRUE(!moving || int(line.size()) < columns) << line;
        }
        EXPECT_TRUE(found) << text;
    }
    EXPECT_EQ(eventide(run).error.find('\r'), std::string::npos);
    std::vector<std::string> quiet = run;
    quiet.push_back("--quiet");
    EXPECT_EQ(eventide(quiet, {.error_to_terminal = true}).error, "");
}

TEST_F(ExitCodes, ColourIsForTerminalsAndNoColorIsRespected) {
    const auto throw_usage = [&](ProcessSettings settings) {
        return eventide({"run", "nothing.raw", "--out", "null"}, std::move(settings)).error;
    };
    const std::string escape = "\033[";
    EXPECT_EQ(throw_usage({}).find(escape), std::string::npos);
    EXPECT_NE(
        throw_usage({.environment = {{"TERM", "xterm"}}, .error_to_terminal = true}).find(escape),
        std::string::npos);
    EXPECT_EQ(throw_usage({.environment = {{"TERM", "xterm"}, {"NO_COLOR", "1"}},
                           .error_to_terminal = true})
                  .find(escape),
              std::string::npos);
}

}  // namespace
}  // namespace eventide::test
