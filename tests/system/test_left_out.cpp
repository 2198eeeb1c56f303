// Recordings that are damaged, or of which much is left out: what is said of it.
#include "tests/system/program_test.h"

#include <string>
#include <vector>

namespace eventide::test {
namespace {

class LeftOut : public ProgramTest {};

TEST_F(LeftOut, ADeliberateEndIsNoDamage) {
    std::string text = "16 16\n";
    for (int i = 0; i < 100'000; ++i)
        text += std::to_string(1'000'000 + 10 * i) + " 1 2 1 a_long_line_that_a_chunk_ends_in\n";
    write_text(temp_ / "long.txt", text);
    const Result cut =
        eventide({"run", "long.txt", "--duration", "30ms", "--out", "null", "--strict"});
    EXPECT_EQ(cut.exit_code, 0) << cut.error;
}

TEST_F(LeftOut, EventsLeftOutForTheirTimesAreSaidByEveryCommand) {
    std::string text = "16 16\n";
    for (int i = 0; i < 1000; ++i)
        text += std::to_string(1'000'000 + 500 * i - (i % 3 == 2 ? 250'000 : 0)) + " 1 2 1\n";
    write_text(temp_ / "mixed.txt", text);
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"info", "mixed.txt"},
          {"run", "mixed.txt", "--out", "null"},
          {"convert", "mixed.txt", "mixed.aedat4"},
          {"convert", "mixed.txt", "tenth.aedat4", "--filter", "subsample:10"}}) {
        const Result result = eventide(command);
        EXPECT_EQ(result.exit_code, 0);
        EXPECT_NE(result.error.find("events already read; a larger --reorder"), std::string::npos)
            << command[0] << "\n"
            << result.error;
        EXPECT_NE(result.error.find("326 events (33 %)"), std::string::npos) << result.error;
    }
    EXPECT_EQ(eventide({"info", "mixed.txt", "--reorder", "1s", "--strict"}).exit_code, 0);
    write_text(temp_ / "one.txt", "16 16\n0.2 1 2 1\n0.1 1 2 1\n");
    expect(0, {"convert", "one.txt", "one.aedat4"}, "one.txt: 1 event (50 %) left out");
    write_text(temp_ / "cut.aedat4", read_text(recording()).substr(0, 3000));
    expect(0, {"convert", "cut.aedat4", "cut.txt"}, "left out as damaged: truncated 1\n");
}

TEST_F(LeftOut, StandardInputAndOutputAreCalledByTheirNames) {
    const Result result = eventide({"convert", "-", "-", "--to-format", "text"},
                                   {.input = "16 16\n0.2 1 2 1\n0.1 1 2 1\n"});
    EXPECT_EQ(result.exit_code, 0) << result.error;
    for (const char* words : {"info: standard output: wrote 1 event",
                              "warning: standard input: 1 event (50 %) left out"})
        EXPECT_NE(result.error.find(words), std::string::npos) << words << "\n" << result.error;
}

TEST_F(LeftOut, ARecordingOfWhichMostIsLeftOutIsSaidByEveryCommand) {
    std::string text = "16 16\n";  // the first rows are in order, and those behind go back
    for (int i = 0; i < 5000; ++i)
        text += std::to_string(1'000'000 + (i < 1000 ? 500 * i : 100 * (i % 1000))) + " 1 2 1\n";
    write_text(temp_ / "backwards.txt", text);
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"info", "backwards.txt"},
          {"run", "backwards.txt", "--out", "null", "--quiet"},
          {"convert", "backwards.txt", "backwards.aedat4"}}) {
        const Result result = eventide(command);
        EXPECT_EQ(result.exit_code, 0);
        EXPECT_NE(result.error.find("warning: backwards.txt: 80 % of it was left out"),
                  std::string::npos)
            << command[0] << "\n"
            << result.error;
    }
    const Result off_sensor = eventide({"info", "backwards.txt", "--input-size", "1x1"});
    EXPECT_NE(off_sensor.error.find("100 % of it was left out as damaged: out_of_range 5000; "
                                    "--input-size"),
              std::string::npos)
        << off_sensor.error;
}

}  // namespace
}  // namespace eventide::test
