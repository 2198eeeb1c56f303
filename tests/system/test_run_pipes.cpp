// eventide run between other programs: standard input and output, named pipes.
#include "tests/system/program_test.h"

#include <gtest/gtest.h>

#include <sys/stat.h>

#include <filesystem>
#include <string>

namespace eventide::test {
namespace {

class RunPipes : public ProgramTest {};

TEST_F(RunPipes, StreamsY4mToStandardOutputAndFfmpegReadsIt) {
    std::string command = EVENTIDE_PROGRAM;
    command.append(" run ").append(recording()).append(" --model ").append(model());
    command +=
        " --fps 200 --out - | ffprobe -v error -count_frames "
        "-show_entries stream=nb_read_frames,r_frame_rate,width -of csv=p=0 -";
    const Result result = run({"bash", "-c", command});
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_TRUE(result.output == "64,200/1,80\n" || result.output == "64,200/1,81\n")
        << result.output;
}

TEST_F(RunPipes, ReadsTextFromStandardInput) {
    std::string text = "16 16\n";
    for (int i = 0; i < 2000; ++i)
        text += "0." + std::to_string(100'000 + 50 * i) + " " + std::to_string(i % 16) + " " +
                std::to_string(i / 16 % 16) + " " + std::to_string(i % 2) + "\n";
    const Result result =
        eventide({"run", "-", "--fps", "50", "--out", "gray8:-"}, {.input = text});
    ASSERT_EQ(result.exit_code, 0) << result.error;
    EXPECT_EQ(result.output.size() % 256, 0U);
    EXPECT_GE(result.output.size(), 256U * 4);
}

TEST_F(RunPipes, GoesThroughANamedPipe) {
    ASSERT_EQ(mkfifo((temp_ / "pipe").c_str(), 0600), 0);
    Process process = start({"run", recording(), "--fps", "20", "--out", "gray8:pipe"});
    const std::string bytes = read_text(temp_ / "pipe");
    EXPECT_EQ(process.wait().exit_code, 0);
    EXPECT_GE(bytes.size(), 7U * 64 * 48);
    EXPECT_EQ(bytes.size() % (64 * 48), 0U);
}

TEST_F(RunPipes, GoesThroughSeveralNamedPipesInWhateverOrderTheyAreOpened) {
    for (const std::string opens : {"exec 3<frames 4<events", "exec 4<events 3<frames"}) {
        const Result result = in_shell(
            "rm -f frames events; mkfifo frames events; "
            "eventide run recording --fps 10 --out gray8:frames --events-out text:events & " +
            opens + "; cat <&4 > events.txt & wc -c <&3; wait");
        ASSERT_EQ(result.exit_code, 0) << result.error;
        EXPECT_NE(result.output, "0\n") << opens;
        EXPECT_GT(std::filesystem::file_size(temp_ / "events.txt"), 1000U) << opens;
    }
}

TEST_F(RunPipes, OpensAPipeForItsReaderBeforeAnythingIsWrittenToItsSource) {
    for (const std::string command :
         {"run in --fps 10 --out gray8:out", "convert in out --to-format text"}) {
        const Result result = in_shell("rm -f in out; mkfifo in out; eventide " + command +
                                       " & exec 3<out; cat recording > in & wc -c <&3; wait");
        ASSERT_EQ(result.exit_code, 0) << result.error;
        EXPECT_GT(std::stol(result.output), 1000) << command;
    }
}

}  // namespace
}  // namespace eventide::test
