// The shared library shows its public face and nothing else.
#include "tests/library/library_test.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <string>
#include <vector>

namespace eventide::test {
namespace {

constexpr std::array kPublic{"eventide_",
                             "eventide::version()",
                             "eventide::Reconstructor::",
                             "eventide::EventReader::",
                             "eventide::EventWriter::",
                             "eventide::EventCamera::",
                             "eventide::EventSimulation::",
                             "eventide::EventPipeline::",
                             "eventide::EventSource::",
                             "eventide::FrameSink::",
                             "eventide::PerceptualDistance::",
                             "eventide::measure(",
                             "eventide::push_from(",
                             "eventide::refuse_other_sensor(",
                             "eventide::read_frame(",
                             "typeinfo for eventide::",
                             "typeinfo name for eventide::",
                             "vtable for eventide::",
                             "EVENTIDE_1"};

/// The names that `nm` finds, which must be public; gives how many.
int expect_public(std::vector<std::string> nm, const std::string& file) {
    nm.insert(nm.begin(), {"nm", "--demangle", "--defined-only", "--format=posix"});
    nm.push_back(file);
    const Result result = run(nm);
    EXPECT_EQ(result.exit_code, 0) << result.error;
    std::istringstream lines{result.output};
    int symbols = 0;
    for (std::string line; std::getline(lines, line);) {
        if (line.ends_with(":")) continue;  // the name of an archive's member
        ++symbols;
        EXPECT_TRUE(std::ranges::any_of(kPublic, [&](const char* name) {
            return line.starts_with(name);
        })) << line;
        EXPECT_EQ(line.find("::Impl"), std::string::npos) << line;
    }
    return symbols;
}

TEST(ExportedSymbols, AreThePublicFaceAlone) {
    EXPECT_GT(expect_public({"--dynamic"}, EVENTIDE_CORE_LIBRARY), 40);
    EXPECT_GT(expect_public({"--dynamic"}, EVENTIDE_WHOLE_LIBRARY), 50);
}

TEST(ExportedSymbols, OfTheStaticLibrariesAreTheSame) {
    EXPECT_GT(expect_public({"--extern-only"}, EVENTIDE_CORE_ARCHIVE), 40);
    EXPECT_GT(expect_public({"--extern-only"}, EVENTIDE_WHOLE_ARCHIVE), 50);
}

/// Of the packages that eventide is built with; a sanitizer's runtime is not one of them.
std::vector<std::string> needed_by(const std::string& library) {
    const Result result = run({"readelf", "--dynamic", library});
    EXPECT_EQ(result.exit_code, 0) << result.error;
    std::istringstream lines{result.output};
    std::vector<std::string> names;
    for (std::string line; std::getline(lines, line);) {
        const std::size_t begin = line.find("Shared library: [");
        if (begin == std::string::npos) continue;
        const std::string name = line.substr(begin + 17, line.find(".so", begin) - begin - 17);
        const bool is_of_the_system = name == "libc" || name == "libm" || name == "libstdc++" ||
                                      name == "libgcc_s" || name.starts_with("ld-linux") ||
                                      name == "libasan" || name == "libubsan" || name == "libtsan";
        if (!is_of_the_system) names.push_back(name);
    }
    return names;
}

TEST(NeededPackages, OfEventsToFramesAreHighwayAndTbb) {
    std::vector<std::string> allowed{"libtbb", "libhwy"};
#ifdef EVENTIDE_HAS_ONEDNN
    allowed.insert(allowed.end(), {"libdnnl", "libgomp"});
#endif
    EXPECT_THAT(needed_by(EVENTIDE_CORE_LIBRARY), testing::UnorderedElementsAreArray(allowed));
    EXPECT_THAT(needed_by(EVENTIDE_WHOLE_LIBRARY), testing::Contains("libeventide-core"));
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
