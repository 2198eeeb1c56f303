// The pages of docs/ name every option, format, column and counter that the program has, and no
// option that it has not.
#include "tests/system/program_test.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>

namespace eventide::test {
namespace {

class DocumentedNames : public ProgramTest {};

const std::vector<std::string> kCommands{"run",      "info",     "convert", "devices", "doctor",
                                         "simulate", "evaluate", "bench",   "stress"};

std::set<std::string> options_in(const std::string& text) {
    const std::regex option{R"((?:^|[\s`(,])(--[a-z][a-z0-9-]*))"};
    std::set<std::string> found;
    for (std::sregex_iterator at{text.begin(), text.end(), option}, end; at != end; ++at)
        found.insert((*at)[1]);
    return found;
}

TEST_F(DocumentedNames, TheUsagePageNamesEveryOption) {
    const auto named = options_in(read_text(EVENTIDE_SOURCE_DIR "/docs/usage.md"));
    for (const std::string& command : kCommands) {
        const Result help = eventide({command, "--help"});
        const auto options = options_in(help.output);
        EXPECT_FALSE(options.empty()) << command;
        for (const std::string& option : options)
            EXPECT_TRUE(option == "--help" || named.contains(option)) << command << " " << option;
    }
}

TEST_F(DocumentedNames, CommandsAreShownWithOptionsThatTheyHave) {
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

TEST_F(DocumentedNames, TheModelPageNamesEveryKeyOfAModelFile) {
    const std::string page = read_text(EVENTIDE_SOURCE_DIR "/docs/model.md");
    const std::size_t begin = page.find("\n## Model file\n");
    ASSERT_NE(begin, page.npos);
    const std::string section = page.substr(begin, page.find("\n## ", begin + 1) - begin);
    const auto card = nlohmann::json::parse(eventide({"info", "small", "--json"}).output);
    EXPECT_GT(card.size(), 20U);
    for (const auto& [key, value] : card.items()) {
        if (key == "identity" || key == "weights") continue;  // of the file as a whole
        EXPECT_TRUE(std::regex_search(section, std::regex{"\\|[^|\n]*\\b" + key + "\\b"})) << key;
    }
}

TEST_F(DocumentedNames, TheFormatsPageNamesEveryFormatAndKindOfDamage) {
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

TEST_F(DocumentedNames, ThePagesNameWhatARunWritesAndCounts) {
    const Result made = eventide({"run", "sim:demo?size=64x48&speed=max", "--duration", "200ms",
                                  "--out", "frames/", "--stats", "stats.jsonl"});
    ASSERT_EQ(made.exit_code, 0) << made.error;
    const std::string usage = read_text(EVENTIDE_SOURCE_DIR "/docs/usage.md");
    const std::string csv = read_text(temp_ / "frames/timestamps.csv");
    std::istringstream columns{csv.substr(0, csv.find('\n'))};
    for (std::string column; std::getline(columns, column, ',');)
        EXPECT_NE(usage.find("`" + column + "`"), usage.npos) << column;
    for (const auto& entry : std::filesystem::directory_iterator{temp_ / "frames"}) {
        const std::string name = entry.path().filename().string();
        EXPECT_NE(usage.find("`" + name + (entry.is_directory() ? "/`" : "`")), usage.npos) << name;
    }
    const std::string cameras = read_text(EVENTIDE_SOURCE_DIR "/docs/cameras.md");
    std::istringstream lines{read_text(temp_ / "stats.jsonl")};
    std::string last;
    for (std::string line; std::getline(lines, line);) last = line;
    const auto stats = nlohmann::json::parse(last);
    EXPECT_GT(stats["camera"].size(), 5U);
    for (const auto& [name, count] : stats["camera"].items())
        EXPECT_NE(cameras.find("`" + name + "`"), cameras.npos) << name;
    EXPECT_GT(stats["quality"].size(), 5U);
    for (const auto& [name, value] : stats["quality"].items())
        EXPECT_NE(usage.find("`" + name + "`"), usage.npos) << name;
    for (const auto& [name, value] : stats["work_ms"].items())
        EXPECT_NE(usage.find("`" + name + "`"), usage.npos) << name;
}

}  // namespace
}  // namespace eventide::test
