// Every command in the documentation does what it says: the shell blocks of docs/usage.md are run.
#include "tests/system/program_test.h"

#include <nlohmann/json.hpp>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
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

const std::vector<std::string> kCommands{"run",      "info",     "convert", "devices", "doctor",
                                         "simulate", "evaluate", "bench",   "stress"};

std::set<std::string> options_in(const std::string& text) {
    const std::regex option{R"((?:^|[\s`(,])(--[a-z][a-z0-9-]*))"};
    std::set<std::string> found;
    for (std::sregex_iterator at{text.begin(), text.end(), option}, end; at != end; ++at)
        found.insert((*at)[1]);
    return found;
}

TEST_F(Documentation, TheUsagePageNamesEveryOption) {
    const auto named = options_in(read_text(EVENTIDE_SOURCE_DIR "/docs/usage.md"));
    for (const std::string& command : kCommands) {
        const Result help = eventide({command, "--help"});
        const auto options = options_in(help.output);
        EXPECT_FALSE(options.empty()) << command;
        for (const std::string& option : options)
            EXPECT_TRUE(option == "--help" || named.contains(option)) << command << " " << option;
    }
}

TEST_F(Documentation, CommandsAreShownWithOptionsThatTheyHave) {
    std::map<std::string, std::set<std::string>> has;
    for (const std::string& command : kCommands)
        has[command] = options_in(eventide({command, "--help"}).output);
    const auto of_all = options_in(eventide({"--help"}).output);
    const std::regex call{R"((?:^|[\s`(])eventide (\w+)([^`|\n#]*))"};
    std::vector<std::filesystem::path> pages{EVENTIDE_SOURCE_DIR "/README.md"};
    for (const auto& page : std::filesystem::directory_iterator{EVENTIDE_SOURCE_DIR "/docs"})
        if (page.path().extension() == ".md") pages.push_back(page.path());
    int calls = 0;
    for (const auto& page : pages) {
        const std::string text = read_text(page);
        for (std::sregex_iterator at{text.begin(), text.end(), call}, end; at != end; ++at) {
            if (!has.contains((*at)[1])) continue;  // eventide help, eventide and OpenCV
            ++calls;
            for (const std::string& option : options_in((*at)[2]))
                EXPECT_TRUE(has[(*at)[1]].contains(option) || of_all.contains(option))
                    << page << ": " << (*at)[0] << ": " << option;
        }
    }
    EXPECT_GT(calls, 100);
}

TEST_F(Documentation, TheModelPageNamesEveryKeyOfAModelFile) {
    const std::string page = read_text(EVENTIDE_SOURCE_DIR "/docs/model.md");
    const std::size_t begin = page.find("\n## Model file\n");
    ASSERT_NE(begin, page.npos);
    const std::string section = page.substr(begin, page.find("\n## ", begin + 1) - begin);
    const auto card = nlohmann::json::parse(eventide({"info", "small", "--json"}).output);
    EXPECT_GT(card.size(), 20U);
    for (const auto& [key, value] : card.items())
        if (key != "identity" && key != "weights")  // of the file as a whole
            EXPECT_TRUE(std::regex_search(section, std::regex{"\\|[^|\n]*\\b" + key + "\\b"}))
                << key;
}

TEST_F(Documentation, TheFormatsPageNamesEveryFormatAndKindOfDamage) {
    const std::string page = read_text(EVENTIDE_SOURCE_DIR "/docs/formats.md");
    const auto info = nlohmann::json::parse(eventide({"info", recording(), "--json"}).output);
    EXPECT_GT(info["damaged"].size(), 5U);
    for (const auto& [reason, count] : info["damaged"].items())
        EXPECT_NE(page.find("\n| `" + reason + "` |"), page.npos) << reason;
    // "expected auto, aedat4, ..., found 'none'"
    const std::string refusal = eventide({"info", recording(), "--input-format", "none"}).error;
    const std::size_t begin = refusal.find("expected ") + 9;
    std::string names = refusal.substr(begin, refusal.find(", found") - begin);
    const std::regex name{R"(\w+)"};
    int formats = 0;
    for (std::sregex_iterator at{names.begin(), names.end(), name}, end; at != end; ++at) {
        if (at->str() == "auto" || at->str() == "or") continue;
        ++formats;
        EXPECT_NE(page.find("`" + at->str() + "`"), page.npos) << at->str();
    }
    EXPECT_GT(formats, 10) << refusal;
}

}  // namespace
}  // namespace eventide::test
