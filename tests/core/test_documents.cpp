// What people read first names no file, and no heading, that is not there.
#include <gtest/gtest.h>

#include <glob.h>

#include <cctype>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace eventide {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = EVENTIDE_SOURCE_DIR;

std::vector<fs::path> documents() {
    std::vector<fs::path> found{kRoot / "README.md", kRoot / "CONTRIBUTING.md"};
    for (const auto& entry : fs::recursive_directory_iterator{kRoot / "docs"})
        if (entry.path().extension() == ".md") found.push_back(entry.path());
    return found;
}

std::string text_of(const fs::path& file) {
    std::ifstream stream{file};
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
}

/// A file, a folder, or with * in it at least one of them. A source file may go without its
/// extension.
bool is_there(const fs::path& path) {
    glob_t matches{};
    bool found = false;
    for (const char* extension : {"", ".cpp", ".h"})
        found =
            found || glob((path.string() + extension).c_str(), GLOB_BRACE, nullptr, &matches) == 0;
    globfree(&matches);
    return found;
}

std::vector<std::string> matches_of(const std::string& text, const std::regex& pattern) {
    std::vector<std::string> found;
    for (std::sregex_iterator at{text.begin(), text.end(), pattern}, end; at != end; ++at)
        found.push_back((*at)[1]);
    return found;
}

TEST(Documents, LinksLeadToFiles) {
    const std::regex link{R"(\]\(([^)#: ]+)(#[^)]*)?\))"};
    for (const fs::path& document : documents())
        for (const std::string& target : matches_of(text_of(document), link))
            EXPECT_TRUE(is_there(document.parent_path() / target)) << document << ": " << target;
}

/// As GitHub makes it of a heading: small letters, no punctuation but - and _, - for a blank.
std::string anchor_of(const std::string& heading) {
    std::string anchor;
    for (const char c : heading)
        if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_')
            anchor += char(std::tolower(static_cast<unsigned char>(c)));
        else if (c == ' ')
            anchor += '-';
    return anchor;
}

std::set<std::string> anchors_of(const fs::path& document) {
    std::set<std::string> found;
    std::istringstream lines{text_of(document)};
    bool code = false;
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("```")) code = !code;
        const std::size_t marks = line.find_first_not_of('#');
        if (!code && marks > 0 && marks < line.size() && line[marks] == ' ')
            found.insert(anchor_of(line.substr(marks + 1)));
    }
    return found;
}

TEST(Documents, AnchorsLeadToHeadings) {
    const std::regex link{R"(\]\(([^):# ]*#[^) ]+)\))"};
    std::size_t count = 0;
    for (const fs::path& document : documents())
        for (const std::string& target : matches_of(text_of(document), link)) {
            const std::string file = target.substr(0, target.find('#'));
            const fs::path page = file.empty() ? document : document.parent_path() / file;
            const std::string anchor = target.substr(target.find('#') + 1);
            EXPECT_TRUE(anchors_of(page).contains(anchor)) << document << ": " << target;
            ++count;
        }
    EXPECT_GT(count, 20U) << "else the pattern finds nothing";
}

TEST(Documents, TheReadmeLeadsToEveryPage) {
    const std::string readme = text_of(kRoot / "README.md");
    for (const auto& entry : fs::directory_iterator{kRoot / "docs"})
        if (entry.path().extension() == ".md") {
            const std::string page = "(docs/" + entry.path().filename().string();
            EXPECT_NE(readme.find(page), readme.npos) << page;
        }
}

TEST(Documents, PathsOfTheSourceTreeAreThere) {
    // Not behind another path: build/release/apps/cli is what a build makes.
    const std::regex path{
        R"((?:^|[\s`("'])((?:src|apps|pipeline|replay|drivers|tests|docs|config|scripts|\.ci)/[\w./*{},-]*[\w*}/]))"};
    std::size_t count = 0;
    for (const fs::path& document : documents())
        for (const std::string& named : matches_of(text_of(document), path)) {
            ++count;
            EXPECT_TRUE(is_there(kRoot / named)) << document << ": " << named;
        }
    EXPECT_GT(count, 50U) << "else the pattern finds nothing";
}

}  // namespace
}  // namespace eventide
