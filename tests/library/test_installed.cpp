// The installed tree: what lies in it, its headers, its documentation and its service.
#include "tests/library/installed_test.h"

#include <filesystem>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace eventide::test {
namespace {

namespace fs = std::filesystem;

TEST_F(Installed, HeadersCompileAloneAndWithEveryWarning) {
    for (const auto& entry : fs::directory_iterator{prefix() + "/include/eventide"}) {
        const std::string header = entry.path().filename().string();
        write_text(temp_ / "alone.cpp", "#include <eventide/" + header + ">\nint main() {}\n");
        succeed({"c++", "-std=c++20", "-fsyntax-only", "-Wall", "-Wextra", "-Wpedantic",
                 "-Wconversion", "-Wshadow", "-Werror", "-I", prefix() + "/include",
                 temp_ / "alone.cpp"});
    }
}

TEST_F(Installed, HeaderOfCIsC99) {
    write_text(temp_ / "alone.c", "#include <eventide/eventide.h>\nint main(void) { return 0; }\n");
    succeed({"cc", "-std=c99", "-pedantic", "-fsyntax-only", "-Wall", "-Wextra",
             "-Wstrict-prototypes", "-Werror", "-I", prefix() + "/include", temp_ / "alone.c"});
}

TEST_F(Installed, TreeHasTheModelsTheCamerasAndTheLicence) {
    std::size_t models = 0;
    for (const auto& entry :
         fs::recursive_directory_iterator{prefix() + "/share/eventide/models"}) {
        EXPECT_EQ(entry.path().extension(), ".safetensors") << "no folder of checkpoints";
        ++models;
    }
    EXPECT_GE(models, 3U);
    for (const char* const file :
         {"share/eventide/cameras/davis346.toml", "share/eventide/default.toml",
          "share/doc/eventide/LICENSE", "share/doc/eventide/docs/usage.md",
          "lib/udev/rules.d/65-eventide.rules", "lib/systemd/system/eventide@.service",
          "bin/eventide", "share/man/man1/eventide.1", "share/bash-completion/completions/eventide",
          "share/zsh/vendor-completions/_eventide",
          "share/fish/vendor_completions.d/eventide.fish"})
        EXPECT_TRUE(fs::exists(prefix() + "/" + file)) << file;
}

/// The files that the links of a page name: of other pages, pictures, examples.
std::vector<std::string> links_of(const fs::path& page) {
    static const std::regex link{R"(\]\(([^)#: ]+)(#[^)]*)?\))"};
    const std::string text = read_text(page.string());
    std::vector<std::string> found;
    for (std::sregex_iterator at{text.begin(), text.end(), link}, end; at != end; ++at)
        found.push_back((*at)[1]);
    return found;
}

TEST_F(Installed, LinksOfTheDocumentationLeadToInstalledFiles) {
    std::size_t pictures = 0;
    for (const auto& page : fs::recursive_directory_iterator{prefix() + "/share/doc/eventide"}) {
        if (page.path().extension() != ".md") continue;
        for (const std::string& link : links_of(page.path())) {
            EXPECT_TRUE(fs::exists(page.path().parent_path() / link)) << page << ": " << link;
            pictures += fs::path{link}.extension() == ".svg";
        }
    }
    EXPECT_GT(pictures, 3U) << "else the pattern finds nothing";
}

TEST_F(Installed, SystemdHasNothingToSayOfTheService) {
    if (run({"sh", "-c", "command -v systemd-analyze"}).exit_code != 0)
        GTEST_SKIP() << "systemd-analyze is not installed (Debian's systemd)";
    const auto complaints = [&](const std::string& unit) {
        write_text(temp_ / "eventide@front.service", unit);
        // Also of units of this machine's, which are none of ours.
        const Result said =
            run({"systemd-analyze", "verify", "--man=no", "./eventide@front.service"},
                {.folder = temp_.path().string()});
        std::string ours;
        std::istringstream lines{said.error};
        for (std::string line; std::getline(lines, line);)
            if (line.find("eventide@front") != line.npos) ours += line + "\n";
        return ours;
    };
    // By name, so that it is found wherever a package or an installation from source puts it.
    const std::string installed = read_text(prefix() + "/lib/systemd/system/eventide@.service");
    EXPECT_NE(installed.find("\nExecStart=eventide run ${SOURCE}\n"), installed.npos);
    const std::string unit = std::regex_replace(installed, std::regex{"ExecStart=[^ ]*"},
                                                "ExecStart=" + prefix() + "/bin/eventide");
    EXPECT_EQ(complaints(unit), "");
    EXPECT_NE(complaints(unit + "NoSuchKey=1\n"), "") << "the check checks";
}

}  // namespace
}  // namespace eventide::test
