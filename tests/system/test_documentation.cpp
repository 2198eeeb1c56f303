// Every command in the documentation does what it says: the shell blocks of docs/usage.md are run.
#include "tests/system/program_test.h"

#include <filesystem>
#include <sstream>

namespace eventide::test {
namespace {

class Documentation : public ProgramTest {};

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
    const std::string program = EVENTIDE_PROGRAM;
    const std::string path =
        std::filesystem::path{program}.parent_path().string() + ":" + std::getenv("PATH");
    std::filesystem::copy_file(recording(), temp_ / "recording.aedat4");
    for (const std::string& block : blocks) {
        const Result result =
            run({"bash", "-euo", "pipefail", "-c", block},
                {.environment = {{"PATH", path},
                                 {"EVENTIDE_MODELS", std::filesystem::path{model()}.parent_path()}},
                 .folder = temp_.path()});
        EXPECT_EQ(result.exit_code, 0) << block << result.error;
    }
}

}  // namespace
}  // namespace eventide::test
