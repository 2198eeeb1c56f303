// Holds the arrows of the architecture: which folder may include what.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace {

namespace fs = std::filesystem;

struct Include {
    std::string file;    // relative to the project's root
    std::string target;  // between the quotes or brackets
};

/// The target of an #include line, or empty.
std::string include_target(std::string_view line) {
    const auto start = line.find_first_not_of(" \t");
    if (start == line.npos || !line.substr(start).starts_with("#include")) return {};
    const auto open = line.find_first_of("<\"", start);
    if (open == line.npos) return {};
    const auto close = line.find_first_of(">\"", open + 1);
    return close == line.npos ? "" : std::string{line.substr(open + 1, close - open - 1)};
}

std::vector<Include> includes_below(const std::vector<std::string>& folders) {
    std::vector<Include> found;
    const fs::path root{EVENTIDE_SOURCE_DIR};
    for (const std::string& folder : folders)
        for (const auto& entry : fs::recursive_directory_iterator{root / folder}) {
            const auto extension = entry.path().extension();
            if (extension != ".h" && extension != ".cpp" && extension != ".hpp" &&
                extension != ".inl")
                continue;
            std::ifstream file{entry.path()};
            for (std::string line; std::getline(file, line);)
                if (std::string target = include_target(line); !target.empty())
                    found.push_back({fs::relative(entry.path(), root).string(), target});
        }
    return found;
}

/// A header that only some folders (or files) may include.
struct Rule {
    std::string_view target_prefix;
    std::vector<std::string_view> allowed;  // prefixes of files
};

// Programs stand on pipeline, drivers and replay, those on src; nothing points back.
const std::vector<Rule> kRules{
    {"thread", {"apps/", "pipeline/", "replay/", "drivers/"}},
    {"opencv2/",
     {"pipeline/sinks/", "pipeline/calibration/", "pipeline/ros2/", "apps/", "src/simulate/",
      "src/metrics/", "replay/image_file", "src/io/image_codecs"}},
    {"hdf5.h", {"src/io/hdf5/hdf5_library.h"}},
    {"libusb", {"drivers/usb/"}},
    {"httplib.h", {"pipeline/sinks/http/"}},
    {"pipeline/sinks/http/", {"pipeline/sinks/http/", "apps/cli/"}},
    {"dds/", {"pipeline/ros2/"}},
    {"yaml.h", {"pipeline/calibration/yaml_file"}},
    {"pipeline/ros2/", {"pipeline/ros2/", "drivers/ros2/", "apps/cli/"}},
    {"concurrentqueue.h", {"pipeline/link.h", "pipeline/pool.h"}},
    {"torch/", {"apps/train/"}},
    {"oneapi/dnnl", {"src/nn/", "src/kernels/", "src/metrics/"}},
    {"apps/cli/", {"apps/cli/"}},
    {"apps/train/", {"apps/train/"}},
    {"apps/bench/", {"apps/bench/", "apps/cli/"}},
    {"apps/evaluate/", {"apps/evaluate/", "apps/cli/"}},
    {"toml++/", {"src/settings/"}},
    {"src/settings/", {"src/settings/", "apps/", "drivers/", "pipeline/ros2/"}},
    {"src/simulate/", {"src/simulate/", "apps/", "drivers/simulated/", "library/"}},
    {"src/metrics/", {"src/metrics/", "apps/", "library/"}},
    {"src/model/", {"src/model/", "apps/", "pipeline/", "library/"}},
    {"src/nn/", {"src/nn/", "src/model/", "src/metrics/", "apps/", "library/"}},
    {"src/kernels/", {"src/kernels/", "src/nn/", "src/model/", "src/binning/", "src/codec/"}},
    {"drivers/", {"drivers/", "apps/cli/", "library/"}},
    {"replay/", {"replay/", "apps/", "library/"}},
    {"pipeline/", {"pipeline/", "replay/", "drivers/", "apps/", "library/"}},
    {"library/", {"library/"}},
};

bool allowed(const Rule& rule, std::string_view file) {
    for (const std::string_view prefix : rule.allowed)
        if (file.starts_with(prefix)) return true;
    return false;
}

std::vector<Include> violations(const std::vector<Include>& includes) {
    std::vector<Include> bad;
    for (const Include& include : includes)
        for (const Rule& rule : kRules) {
            // "thread" is a whole name, not the beginning of one.
            const bool hit = rule.target_prefix == "thread"
                                 ? include.target == "thread"
                                 : include.target.starts_with(rule.target_prefix);
            if (hit && !allowed(rule, include.file)) bad.push_back(include);
        }
    return bad;
}

TEST(Architecture, ArrowsPointOneWay) {
    const auto includes =
        includes_below({"src", "apps", "pipeline", "drivers", "replay", "library", "include"});
    ASSERT_GT(includes.size(), 50U) << "the sources were not found";
    for (const Include& bad : violations(includes))
        ADD_FAILURE() << bad.file << " may not include " << bad.target;
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
}

TEST(Architecture, IncludesStartAtTheRoot) {
    const fs::path root{EVENTIDE_SOURCE_DIR};
    for (const Include& include :
         includes_below({"src", "apps", "pipeline", "drivers", "replay", "library", "include"}))
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
