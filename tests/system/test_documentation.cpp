// Every command in the documentation does what it says: the shell blocks of docs/usage.md are run.
#include "tests/system/program_test.h"

#include <cstdlib>
#include <filesystem>
#include <sstream>

namespace eventide::test {
namespace {

class Documentation : public ProgramTest {
protected:
    /// With the program in the path and the small model as its default.
    Result run_in_shell(const std::string& script) const {
        const std::filesystem::path program = EVENTIDE_PROGRAM;
        const std::string path = program.parent_path().string() + ":" + std::getenv("PATH");
        const std::string models = std::filesystem::path{model()}.parent_path();
        return run(
            {"bash", "-euo", "pipefail", "-c", script},
            {.environment = {{"PATH", path}, {"EVENTIDE_MODELS", models}}, .folder = temp_.path()});
    }
};

/// The ```sh blocks of a page; others (```text) are not for running.
std::vector<std::string> shell_blocks(const std::string& page) {
    std::vector<std::string> blocks;
    bool inside = false;
    std::istringstream lines{page};
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("```")) {
            inside = line == "```sh";
            if (inside) blocks.emplace_back();
        } else if (inside) {
            blocks.back() += line + "\n";
        }
    }
    return blocks;
}

TEST_F(Documentation, EveryShellBlockOfTheUsagePageRuns) {
    const auto blocks = shell_blocks(read_text(EVENTIDE_SOURCE_DIR "/docs/usage.md"));
    ASSERT_GT(blocks.size(), 5U);
    std::filesystem::copy_file(recording(), temp_ / "recording.aedat4");
    for (const std::string& block : blocks) {
        const Result result = run_in_shell(block);
        EXPECT_EQ(result.exit_code, 0) << block << result.error;
    }
}

TEST_F(Documentation, TheReaderOfStampedFramesReadsThem) {
    const std::string page = read_text(EVENTIDE_SOURCE_DIR "/docs/usage.md");
    const std::string begin = "```python\n";
    const std::size_t at = page.find(begin);
    ASSERT_NE(at, page.npos);
    const std::size_t body = at + begin.size();
    write_text(temp_ / "reader.py", page.substr(body, page.find("```", body) - body));
    std::filesystem::copy_file(recording(), temp_ / "recording.aedat4");
    const Result result = run_in_shell(
        "eventide run recording.aedat4 --fps 50 --out frames/ --out gray8:- --stamp --quiet | "
        "python3 reader.py 64 48");
    ASSERT_EQ(result.exit_code, 0) << result.error;
    std::istringstream lines{result.output};
    std::vector<long long> times;
    long long index = 0, t_us = 0, flags = 0;
    for (double mean = 0; lines >> index >> t_us >> flags >> mean; times.push_back(t_us)) {
        EXPECT_EQ(index, times.size());
        EXPECT_EQ(flags, 0);
        EXPECT_GT(mean, 0);
    }
    EXPECT_EQ(times, column(temp_ / "frames/timestamps.csv", 2));
}

/// The lines of code blocks that call the program, without those of ```text, which need a camera.
std::vector<std::string> program_lines(const std::string& page) {
    std::vector<std::string> found;
    bool inside = false;
    std::istringstream lines{page};
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("```")) inside = !inside && line == "```";
        if (inside && line.starts_with("eventide ")) found.push_back(line);
    }
    return found;
}

TEST_F(Documentation, EveryCommandOfTheReadmeRuns) {
    const std::string readme = EVENTIDE_SOURCE_DIR "/README.md";
    const auto lines = program_lines(read_text(readme));
    EXPECT_GE(lines.size(), 3U);
    std::filesystem::copy_file(recording(), temp_ / "recording.aedat4");
    for (const std::string& line : lines) {
        const Result result = run_in_shell(line);
        EXPECT_EQ(result.exit_code, 0) << line << "\n" << result.error;
    }
}

}  // namespace
}  // namespace eventide::test
