// Exit codes and words: each kind of trouble has its own, and nothing is written where it should
// not.
#include "tests/system/program_test.h"

#include <filesystem>
#include <sstream>
#include <string>

namespace eventide::test {
namespace {

class ExitCodes : public ProgramTest {};

TEST_F(ExitCodes, HelpAndVersionAreData) {
    for (const char* flag : {"--help", "--version", "help"}) {
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
        std::istringstream lines{result.output};
        for (std::string line; std::getline(lines, line);)
            EXPECT_LE(line.size(), 80U) << command << ": " << line;
        EXPECT_EQ(eventide({"help", command}).output, result.output);
    }
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
    expect(4, {"run", "davis:nobody", "--out", "null"},
           "no DAVIS with serial 'nobody' found; run eventide devices");
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

}  // namespace
}  // namespace eventide::test
