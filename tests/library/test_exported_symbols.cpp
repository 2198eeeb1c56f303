// The shared library shows its public face and nothing else.
#include "tests/library/library_test.h"

#include <algorithm>
#include <array>
#include <sstream>

namespace eventide::test {
namespace {

constexpr std::array kPublic{"eventide_",
                             "eventide::version()",
                             "eventide::Reconstructor::",
                             "eventide::EventReader::",
                             "eventide::EventWriter::",
                             "eventide::EventCamera::",
                             "eventide::EventSimulation::",
                             "eventide::measure(",
                             "typeinfo for eventide::Error",
                             "typeinfo name for eventide::Error",
                             "vtable for eventide::Error",
                             "EVENTIDE_1"};

TEST(ExportedSymbols, AreThePublicFaceAlone) {
    const Result result = run({"nm", "--dynamic", "--demangle", "--defined-only", "--format=posix",
                               EVENTIDE_SHARED_LIBRARY});
    ASSERT_EQ(result.exit_code, 0) << result.error;
    std::istringstream lines{result.output};
    int symbols = 0;
    for (std::string line; std::getline(lines, line); ++symbols) {
        EXPECT_TRUE(std::ranges::any_of(kPublic, [&](const char* name) {
            return line.starts_with(name);
        })) << line;
        EXPECT_EQ(line.find("::Impl"), std::string::npos) << line;
    }
    EXPECT_GT(symbols, 50);
}

TEST(Version, OfTheLibraryIsThatOfTheHeaders) {
    EXPECT_EQ(version(), std::to_string(EVENTIDE_VERSION_MAJOR) + "." +
                             std::to_string(EVENTIDE_VERSION_MINOR) + "." +
                             std::to_string(EVENTIDE_VERSION_PATCH));
    EXPECT_EQ(
        run({EVENTIDE_PROGRAM, "--version"}).output.find(std::string{"eventide "} + version()), 0U);
}

}  // namespace
}  // namespace eventide::test
