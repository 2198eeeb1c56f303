// What people read first names no file that is not there.
#include <gtest/gtest.h>

#include <glob.h>

#include <filesystem>
#include <fstream>
#include <regex>
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
