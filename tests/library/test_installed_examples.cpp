// Examples and the blocks of the documents, against the installed tree.
#include "tests/library/installed_test.h"

#include <filesystem>
#include <sstream>

namespace eventide::test {
namespace {

namespace fs = std::filesystem;

/// Lines that are neither empty nor comments.
int lines_of_code(const std::string& file) {
    std::istringstream lines{read_text(file)};
    int count = 0;
    for (std::string line; std::getline(lines, line);)
        if (const auto at = line.find_first_not_of(' '); at != line.npos)
            count += line.compare(at, 2, "/*") != 0 && line.compare(at, 2, "//") != 0;
    return count;
}

TEST_F(Installed, ConsumersAreTwentyLines) {
    for (const char* const name : {"reconstruct.cpp", "reconstruct.c", "reconstruct.py"})
        EXPECT_LE(lines_of_code(example(name)), 20) << name;
}

TEST_F(Installed, ErrorIsPlottedAgainstSigma) {
#ifdef EVENTIDE_PYTHON
    const auto plotted = [&](const std::string& seconds) {
        return run(
            {EVENTIDE_PYTHON, example("error_against_sigma.py"), temp_ / "plot.svg", seconds},
            {.environment = {{"PYTHONPATH", prefix() + "/" EVENTIDE_PYTHON_DIR},
                             {"EVENTIDE_MODELS", ""}}});
    };
    const Result wrong = plotted("soon");
    EXPECT_EQ(wrong.exit_code, 1);
    EXPECT_EQ(wrong.error, "error_against_sigma.py [PLOT.svg [SECONDS]]\n");
    const Result none = plotted("0.001");
    EXPECT_EQ(none.exit_code, 1);
    EXPECT_NE(none.error.find(": expected SECONDS long enough for a frame, found 0.001\n"),
              std::string::npos)
        << none.error;
    EXPECT_FALSE(std::filesystem::exists(temp_ / "plot.svg"));
    const Result result = plotted("0.6");
    ASSERT_EQ(result.exit_code, 0) << result.error;
    EXPECT_NE(result.output.find("frames: "), std::string::npos) << result.output;
    EXPECT_EQ(result.output.find("nan"), std::string::npos) << result.output;
    const std::string plot = read_text(temp_ / "plot.svg");
    std::size_t points = 0;
    for (std::size_t at = 0; (at = plot.find("<circle", at)) != std::string::npos; ++at) ++points;
    EXPECT_EQ(points, 12U) << plot;
    EXPECT_TRUE(plot.ends_with("</svg>\n"));
#else
    GTEST_SKIP() << "built without EVENTIDE_PYTHON";
#endif
}

/// The first block of a document in this language.
std::string snippet(const std::string& document, const std::string& language) {
    const std::string page = read_text(EVENTIDE_SOURCE_DIR "/" + document),
                      fence = "```" + language + "\n";
    const std::size_t begin = page.find(fence);
    if (begin == std::string::npos) return document + " has no block of " + language;
    return page.substr(begin + fence.size(),
                       page.find("```\n", begin + fence.size()) - begin - fence.size());
}

/// "33332 us: 0.42 +- 0.10" without the numbers, which are measured to be fast and not repeatable.
std::vector<std::string> times_in(const std::string& output) {
    std::vector<std::string> times;
    std::istringstream lines{output};
    for (std::string line; std::getline(lines, line);)
        times.push_back(line.substr(0, line.find(" us: ")));
    return times;
}

TEST_F(Installed, SnippetsOfTheDocumentsRunAndAgree) {
    fs::copy_file(recording(), temp_ / "recording.aedat4");
    const ProcessSettings where{
        .environment = {{"PKG_CONFIG_PATH", library_folder() + "/pkgconfig"},
                        {"LD_LIBRARY_PATH", library_folder()},
                        {"PYTHONPATH", prefix() + "/" EVENTIDE_PYTHON_DIR}},
        .folder = temp_.path().string()};
    write_text(temp_ / "snippet.cpp", snippet("README.md", "cpp"));
    write_text(temp_ / "snippet.c", snippet("docs/library.md", "c"));
    write_text(temp_ / "snippet.py", snippet("README.md", "python"));
    succeed({"sh", "-c",
             "c++ -std=c++20 -Wall -Wextra -Werror snippet.cpp -o in_cpp $(pkg-config --cflags "
             "--libs eventide)"},
            where);
    succeed({"sh", "-c",
             "cc -std=c11 -Wall -Wextra -Werror snippet.c -o in_c $(pkg-config --cflags --libs "
             "eventide)"},
            where);
    const Result in_cpp = run({"./in_cpp"}, where), in_c = run({"./in_c"}, where);
    EXPECT_GT(times_in(in_cpp.output).size(), 8U) << in_cpp.error;
    EXPECT_EQ(times_in(in_c.output), times_in(in_cpp.output)) << in_c.error;
#ifdef EVENTIDE_PYTHON
    const Result in_python = run({EVENTIDE_PYTHON, "snippet.py"}, where);
    EXPECT_EQ(times_in(in_python.output), times_in(in_cpp.output)) << in_python.error;
#endif
}

}  // namespace
}  // namespace eventide::test
