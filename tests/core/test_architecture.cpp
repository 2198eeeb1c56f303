// Holds the arrows of the architecture: which folder includes which, and where each package is
// used.
#include "tests/core/include_scan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace eventide {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kSources{"include", "src",     "apps",   "pipeline", "drivers",
                                        "replay",  "library", "python", "examples"};

using Arrows = std::map<std::string, std::set<std::string>>;

// Programs stand on pipeline, drivers and replay, those on src; nothing points back. No more than
// there is: an arrow that goes is taken out here.
const Arrows kArrows{
    {"src/core", {"include"}},
    {"src/codec", {"include", "src/core"}},
    {"src/binning", {"src/core"}},
    {"src/io", {"src/core"}},
    {"src/settings", {"include", "src/core", "src/io"}},
    {"src/kernels", {"src/core"}},
    {"src/nn", {"src/core", "src/io", "src/kernels"}},
    {"src/model", {"include", "src/core", "src/kernels", "src/nn"}},
    {"src/metrics", {"src/core", "src/io", "src/nn"}},
    {"src/simulate", {"src/core", "src/io"}},
    {"pipeline",
     {"include", "src/binning", "src/codec", "src/core", "src/io", "src/model", "src/settings"}},
    {"replay", {"pipeline", "src/binning", "src/codec", "src/core", "src/io"}},
    {"drivers", {"pipeline", "src/codec", "src/core", "src/io", "src/settings", "src/simulate"}},
    {"library",
     {"drivers", "include", "pipeline", "replay", "src/binning", "src/core", "src/metrics",
      "src/model", "src/nn", "src/simulate"}},
    {"python", {"include", "src/core"}},
    {"examples", {"include"}},
    {"apps/bench", {"src/binning", "src/core", "src/model", "src/nn", "src/simulate"}},
    {"apps/evaluate",
     {"pipeline", "replay", "src/binning", "src/core", "src/io", "src/metrics", "src/model",
      "src/simulate"}},
    {"apps/train",
     {"src/binning", "src/core", "src/io", "src/model", "src/nn", "src/settings", "src/simulate"}},
    {"apps/cli",
     {"apps/bench", "apps/evaluate", "drivers", "include", "pipeline", "replay", "src/binning",
      "src/codec", "src/core", "src/io", "src/metrics", "src/model", "src/nn", "src/settings",
      "src/simulate"}},
};

/// "src/core" of "src/core/array.h", "pipeline" of "pipeline/pipeline.h".
std::string folder_of(const std::string& file) {
    const bool two = file.starts_with("src/") || file.starts_with("apps/");
    const std::size_t first = file.find('/');
    return file.substr(0, two ? file.find('/', first + 1) : first);
}

Arrows arrows_of(const std::vector<Include>& includes) {
    Arrows found;
    for (const Include& include : includes) {
        const std::string target =
            (include.target.starts_with("eventide/") ? "include/" : "") + include.target;
        if (!fs::exists(fs::path{EVENTIDE_SOURCE_DIR} / target)) continue;
        const std::string from = folder_of(include.file), to = folder_of(target);
        if (from != to) found[from].insert(to);
    }
    return found;
}

/// What is in one and not in the other, as "a -> b".
std::set<std::string> beyond(const Arrows& some, const Arrows& others) {
    std::set<std::string> left;
    for (const auto& [from, targets] : some)
        for (const std::string& to : targets)
            if (!others.contains(from) || !others.at(from).contains(to))
                left.insert(from + " -> " + to);
    return left;
}

/// A header that only some folders (or files) may include.
struct Rule {
    std::string_view target_prefix;
    std::vector<std::string_view> allowed;  // prefixes of files
};

const std::vector<Rule> kRules{
    {"thread", {"apps/", "pipeline/", "drivers/", "python/aside.h", "python/interruptible_run.h"}},
    {"opencv2/",
     {"pipeline/demosaiced.cpp", "pipeline/sinks/", "apps/", "replay/image_file",
      "src/io/image_codecs", "examples/"}},
    {"hdf5.h", {"src/io/hdf5/hdf5_library.h"}},
    {"libusb", {"drivers/usb/"}},
    {"httplib.h", {"pipeline/sinks/http/"}},
    {"dds/", {"pipeline/ros2/"}},
    {"yaml.h", {"pipeline/calibration/yaml_file"}},
    {"concurrentqueue.h", {"pipeline/link.h", "pipeline/pool.h"}},
    {"torch/", {"apps/train/"}},
    {"oneapi/dnnl", {"src/nn/"}},
    {"toml++/", {"src/settings/"}},
    {"pybind11/", {"python/"}},
    {"pipeline/sinks/http/", {"pipeline/sinks/http/", "apps/cli/"}},
    {"pipeline/ros2/", {"pipeline/ros2/", "drivers/ros2/", "apps/cli/"}},
};

bool applies(const Rule& rule, const Include& include) {
    // "thread" is a whole name, not the beginning of one.
    return rule.target_prefix == "thread" ? include.target == "thread"
                                          : include.target.starts_with(rule.target_prefix);
}

std::vector<Include> violations(const std::vector<Include>& includes) {
    std::vector<Include> bad;
    for (const Include& include : includes)
        for (const Rule& rule : kRules)
            if (applies(rule, include) &&
                std::ranges::none_of(rule.allowed, [&](std::string_view prefix) {
                    return include.file.starts_with(prefix);
                }))
                bad.push_back(include);
    return bad;
}

TEST(Architecture, ArrowsBetweenFoldersAreTheseAndNoOthers) {
    const Arrows found = arrows_of(includes_below(kSources));
    ASSERT_GT(found.size(), 10U) << "the sources were not found";
    EXPECT_EQ(beyond(found, kArrows), std::set<std::string>{}) << "not foreseen";
    EXPECT_EQ(beyond(kArrows, found), std::set<std::string>{}) << "no longer there";
}

TEST(Architecture, PackagesAreUsedWhereTheyBelong) {
    for (const Include& bad : violations(includes_below(kSources)))
        ADD_FAILURE() << bad.file << " may not include " << bad.target;
}

TEST(Architecture, NoAllowanceIsLeftOver) {
    const auto includes = includes_below(kSources);
    for (const Rule& rule : kRules)
        for (const std::string_view prefix : rule.allowed)
            EXPECT_TRUE(std::ranges::any_of(includes,
                                            [&](const Include& include) {
                                                return applies(rule, include) &&
                                                       include.file.starts_with(prefix);
                                            }))
                << prefix << " includes no " << rule.target_prefix;
}

/// Who installs the headers has neither our sources nor the packages we build with.
TEST(Architecture, ThePublicFaceStandsAlone) {
    const auto includes = includes_below({"include"});
    ASSERT_GT(includes.size(), 20U) << "the headers were not found";
    for (const Include& include : includes)
        EXPECT_TRUE(include.target.starts_with("eventide/") ||
                    include.target.find_first_of("/.") == std::string::npos ||
                    include.target == "stddef.h" || include.target == "stdint.h")
            << include.file << " may not include " << include.target;
}

TEST(Architecture, TheDetectorSeesAViolation) {
    EXPECT_EQ(violations({{"src/core/a.h", "opencv2/core.hpp"}}).size(), 1U);
    EXPECT_EQ(violations({{"src/binning/a.cpp", "thread"}}).size(), 1U);
    EXPECT_TRUE(violations({{"pipeline/pipeline.h", "thread"}}).empty());
    EXPECT_EQ(include_target("  #include <libusb-1.0/libusb.h> // x"), "libusb-1.0/libusb.h");
    const Arrows back = arrows_of({{"src/core/a.h", "src/nn/backend.h"}});
    EXPECT_EQ(beyond(back, kArrows), std::set<std::string>{"src/core -> src/nn"});
}

using TypesInFiles = std::map<std::string, std::set<std::string>>;

/// The types that a header's lines define outside of other types, with their namespaces.
void add_types(std::istream& header, const std::string& file, TypesInFiles& types) {
    static const std::regex opens{R"(namespace ([\w:]+) \{)"};
    static const std::regex defines{R"((?:struct|class|enum|enum class) (\w+)( final)?( [:{].*)?)"};
    std::vector<std::string> inside{""};
    std::smatch found;
    for (std::string line; std::getline(header, line);) {
        if (std::regex_match(line, found, opens))
            inside.push_back(inside.back() + found.str(1) + "::");
        else if (line.starts_with("}  // namespace") && inside.size() > 1)
            inside.pop_back();
        else if (std::regex_match(line, found, defines))
            types[inside.back() + found.str(1)].insert(file);
    }
}

/// Two that differ in one program are undefined behaviour, which no linker reports.
TEST(Architecture, ATypeIsDefinedInOneHeader) {
    const fs::path root{EVENTIDE_SOURCE_DIR};
    TypesInFiles types;
    for (const std::string& folder : kSources)
        for (const auto& entry : fs::recursive_directory_iterator{root / folder}) {
            if (entry.path().extension() != ".h") continue;
            std::ifstream header{entry.path()};
            add_types(header, fs::relative(entry.path(), root).string(), types);
        }
    EXPECT_EQ(types["eventide::Event"], std::set<std::string>{"include/eventide/event.h"});
    for (const auto& [name, files] : types)
        if (files.size() > 1) ADD_FAILURE() << name << ": " << testing::PrintToString(files);
}

TEST(Architecture, TheDetectorSeesATypeInTwoHeaders) {
    TypesInFiles types;
    for (const char* file : {"a.h", "b.h"}) {
        std::istringstream header{
            "namespace eventide {\nclass Later;\nstruct Bias {\n};\n"
            "}  // namespace eventide\n"};
        add_types(header, file, types);
    }
    EXPECT_EQ(types, (TypesInFiles{{"eventide::Bias", {"a.h", "b.h"}}}));
}

TEST(Architecture, IncludesStartAtTheRoot) {
    const fs::path root{EVENTIDE_SOURCE_DIR};
    for (const Include& include : includes_below(kSources))
        EXPECT_FALSE(include.target.starts_with("../") || include.target.starts_with("./"))
            << include.file << " includes " << include.target;
}

/// Ways to make or replace a file.
constexpr std::string_view kWaysToWrite[]{"ofstream", "fopen(", "imwrite(", "O_CREAT",
                                          "avio_open("};

TEST(Architecture, FilesAreWrittenInOnePlace) {
    const fs::path root{EVENTIDE_SOURCE_DIR};
    for (const char* folder : {"src", "apps", "pipeline", "drivers", "replay", "library"})
        for (const auto& entry : fs::recursive_directory_iterator{root / folder}) {
            const std::string file = fs::relative(entry.path(), root).string();
            // Training writes into a folder of its own, which it goes on with.
            if (!entry.is_regular_file() || file.starts_with("src/io/") ||
                file.starts_with("apps/train/"))
                continue;
            std::ifstream stream{entry.path()};
            for (std::string line; std::getline(stream, line);)
                for (const std::string_view way : kWaysToWrite)
                    EXPECT_EQ(line.find(way), std::string::npos)
                        << file << ": src/io/output_file.h is the way to write files\n"
                        << line;
        }
}

}  // namespace
}  // namespace eventide
