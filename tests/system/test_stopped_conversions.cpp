// What a signal leaves of a conversion, and of a simulation.
#include "tests/system/program_test.h"

#include <signal.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

namespace eventide::test {
namespace {

class StoppedConversions : public ProgramTest {
protected:
    /// By SIGINT, long before its end.
    Result stopped(const std::vector<std::string>& command) const {
        Process process = start(command);
        while (process.running() && !process.catches(SIGINT)) continue;
        process.signal(SIGINT);
        return process.wait();
    }
    /// Takes longer than a signal.
    void write_long_text(const std::string& name) const {
        std::ofstream file{temp_ / name};
        file << "64 48\n";
        for (int i = 0; i < 2'000'000; ++i) file << "0.000001 1 2 1\n";
    }
};

TEST_F(StoppedConversions, DoNotReplaceAWholeFileByAPart) {
    write_long_text("long.txt");
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"convert", "long.txt", "old.aedat4", "--overwrite"},
          {"simulate", "--seconds", "1000", "--size", "64x48", "--out", "old.aedat4",
           "--overwrite"}}) {
        write_text(temp_ / "old.aedat4", "precious");
        const Result result = stopped(command);
        EXPECT_EQ(result.exit_code, 1) << result.error;
        EXPECT_NE(
            result.error.find("old.aedat4: stopped before the end; the file from before stays"),
            std::string::npos)
            << result.error;
        EXPECT_EQ(read_text(temp_ / "old.aedat4"), "precious");
        EXPECT_FALSE(std::filesystem::exists(temp_ / "old.aedat4.part"));
    }
}

TEST_F(StoppedConversions, KeepWhatWasDoneWhereNothingIsLostByIt) {
    write_long_text("long.txt");
    const Result result = stopped({"convert", "long.txt", "new.aedat4"});
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_NE(result.error.find("new.aedat4: stopped before the end; it holds what was read"),
              std::string::npos)
        << result.error;
    EXPECT_EQ(eventide({"info", "new.aedat4", "--strict"}).exit_code, 0);
}

/// A pipe has no end of its own: to stop is how a recording of one ends.
TEST_F(StoppedConversions, OfAPipeReplaceAnEarlierFile) {
    ASSERT_EQ(mkfifo((temp_ / "pipe").c_str(), 0600), 0);
    write_text(temp_ / "old.aedat4", "old");
    Process process =
        start({"convert", "pipe", "old.aedat4", "--input-size", "64x48", "--overwrite"});
    ::signal(SIGPIPE, SIG_IGN);
    std::ofstream pipe{temp_ / "pipe"};
    for (int i = 0; process.running() && !std::filesystem::exists(temp_ / "old.aedat4.part"); ++i)
        pipe << "0.000001 1 2 1\n" << std::flush;
    process.signal(SIGINT);
    for (int i = 0; process.running() && pipe; ++i) pipe << "0.000001 1 2 1\n" << std::flush;
    const Result result = process.wait();
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_EQ(eventide({"info", "old.aedat4", "--strict"}).exit_code, 0);
}

}  // namespace
}  // namespace eventide::test
