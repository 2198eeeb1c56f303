// A whole run that meets a full disk or its own death at any moment.
#include "tests/system/program_test.h"

#include <signal.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <random>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

namespace eventide::test {
namespace {

namespace fs = std::filesystem;

/// How many moments are tried of all there are; scripts/faults.sh asks for more.
long moments(long usual) {
    const char* text = std::getenv("EVENTIDE_FAULT_MOMENTS");
    return text == nullptr ? usual : std::atol(text);
}

class Faults : public ProgramTest {
protected:
    void SetUp() override {
        if (kSanitized) GTEST_SKIP() << "sanitizers want to be preloaded first";
    }

    /// A run with every kind of output that is a file, in a folder of its own.
    static Result run_into(const std::string& folder,
                           std::map<std::string, std::string> environment) {
        fs::create_directory(folder);
        environment["LD_PRELOAD"] = EVENTIDE_WRITE_FAULTS;
        return run({EVENTIDE_PROGRAM,
                    "run",
                    recording(),
                    "--model",
                    model(),
                    "--fps",
                    "200",
                    "--record",
                    "copy.aedat4",
                    "--out",
                    "v.mkv",
                    "--out",
                    "frames/",
                    "--out",
                    "gray8:raw.bin",
                    "--out",
                    "contact-sheet:c.png",
                    "--state-out",
                    "s.safetensors",
                    "--stats",
                    "stats.jsonl"},
                   {.environment = std::move(environment), .folder = folder});
    }
    /// Of a run that meets nothing.
    long writes() const {
        const Result result =
            run_into(temp_ / "whole", {{"EVENTIDE_FAULT_COUNT", temp_ / "writes"}});
        EXPECT_EQ(result.exit_code, 0) << result.error;
        return std::atol(read_text(temp_ / "writes").c_str());
    }
    /// Drawn from all; the same each time. All of them where so many are asked for.
    static std::vector<long> drawn(long all, long count) {
        std::vector<long> every(static_cast<std::size_t>(all));
        for (long n = 0; n < all; ++n) every[std::size_t(n)] = n;
        std::mt19937 random{1};
        std::shuffle(every.begin(), every.end(), random);
        every.resize(std::size_t(std::min(all, count)));
        return every;
    }
};

TEST_F(Faults, ADiskThatIsFullAtAnyWriteEndsTheRunWithItsFilesName) {
    const long all = writes();
    ASSERT_GT(all, 100);
    for (const long n : drawn(all, moments(10))) {
        const std::string folder = temp_ / std::to_string(n);
        const Result result = run_into(
            folder, {{"EVENTIDE_FAULT", "full"}, {"EVENTIDE_FAULT_AT", std::to_string(n)}});
        EXPECT_EQ(result.exit_code, 1) << "write " << n << " of " << all << "\n" << result.error;
        EXPECT_NE(result.error.find("No space left on device"), std::string::npos)
            << "write " << n << ": " << result.error;
        fs::remove_all(folder);
    }
}

TEST_F(Faults, AnEarlierFileStaysWhereTheNewOneDoesNotReachTheDisk) {
    for (const char* name : {"state", "copy.txt"}) {
        write_text(temp_ / name, "old");
        const std::vector<std::string> arguments =
            name == std::string{"state"}
                ? std::vector<std::string>{"run",  recording(),   "--model", model(),      "--out",
                                           "null", "--state-out", name,      "--overwrite"}
                : std::vector<std::string>{"convert", recording(), name, "--overwrite"};
        std::vector<std::string> command{EVENTIDE_PROGRAM};
        command.insert(command.end(), arguments.begin(), arguments.end());
        const auto with = [&](const char* fault) {
            return run(command, {.environment = {{"LD_PRELOAD", EVENTIDE_WRITE_FAULTS},
                                                 {"EVENTIDE_FAULT", fault}},
                                 .folder = temp_.path().string()});
        };
        const Result lost = with("lost");
        EXPECT_EQ(lost.exit_code, 1) << lost.error;
        EXPECT_NE(lost.error.find(name + std::string{": cannot be written: Input/output error"}),
                  std::string::npos)
            << lost.error;
        EXPECT_EQ(read_text(temp_ / name), "old");
        EXPECT_EQ(with("none").exit_code, 0);
        EXPECT_NE(read_text(temp_ / name), "old");
    }
}

bool ends_with(const fs::path& file, const std::string& end) {
    return read_text(file).ends_with(end);
}

/// What has its own name is whole; what grows can be read.
void expect_readable(const std::string& folder, const std::string& moment) {
    const std::string png_end{"IEND\xae\x42\x60\x82", 8};
    std::size_t images = 0;
    if (fs::exists(fs::path{folder} / "frames/frames"))
        for (const auto& entry : fs::directory_iterator{fs::path{folder} / "frames/frames"})
            if (entry.path().extension() == ".png") {
                EXPECT_TRUE(ends_with(entry.path(), png_end)) << moment << ": " << entry.path();
                ++images;
            }
    const fs::path sheet = fs::path{folder} / "c.png";
    EXPECT_TRUE(!fs::exists(sheet) || ends_with(sheet, png_end)) << moment;
    const fs::path table = fs::path{folder} / "frames/timestamps.csv";
    const std::string rows = fs::exists(table) ? read_text(table) : "";
    const auto lines = std::size_t(std::ranges::count(rows, '\n'));
    EXPECT_GE(lines + 1, images) << moment;
    const fs::path copy = fs::path{folder} / "copy.aedat4";
    if (fs::exists(copy) && fs::file_size(copy) > 4096) {
        const Result info = run({EVENTIDE_PROGRAM, "info", copy.string(), "--json"});
        EXPECT_EQ(info.exit_code, 0) << moment << ": " << info.error;
    }
}

TEST_F(Faults, KilledAtAnyWriteItLeavesWhatPlaysAndReads) {
    const long all = writes();
    for (const long n : drawn(all, moments(8))) {
        const std::string folder = temp_ / std::to_string(n);
        const Result result = run_into(
            folder, {{"EVENTIDE_FAULT", "kill"}, {"EVENTIDE_FAULT_AT", std::to_string(n)}});
        EXPECT_EQ(result.exit_code, 128 + SIGKILL) << result.error;
        const std::string moment = "write " + std::to_string(n) + " of " + std::to_string(all);
        expect_readable(folder, moment);
        const std::string table = folder + "/frames/timestamps.csv";
        const std::size_t frames = fs::exists(table) ? column(table, 2).size() : 0;
        // x264 looks 40 frames ahead, and a cluster of Matroska is written when it is full.
        EXPECT_TRUE(frames <= 60 || !packet_times(folder + "/v.mkv").empty()) << moment;
        fs::remove_all(folder);
    }
}

}  // namespace
}  // namespace eventide::test
