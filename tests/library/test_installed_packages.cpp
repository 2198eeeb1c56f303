// The Debian packages.
#include "tests/library/installed_test.h"

#include <filesystem>
#include <map>

namespace eventide::test {
namespace {

namespace fs = std::filesystem;

/// What dpkg says of a package: one field.
std::string field(const std::string& package, const std::string& name) {
    return run({"dpkg-deb", "--field", package, name}).output;
}

TEST_F(Installed, DebianPackagesHoldTheSameAndSayWhatTheyNeed) {
    succeed(
        {"cpack", "--config", EVENTIDE_BUILD_DIR "/CPackConfig.cmake", "-B", temp_ / "packages"});
    std::map<std::string, std::string> packages;
    for (const auto& entry : fs::directory_iterator{temp_ / "packages"})
        if (entry.path().extension() == ".deb") {
            const std::string name = entry.path().filename().string();
            packages[name.substr(0, name.find('_'))] = entry.path().string();
            succeed({"dpkg-deb", "-x", entry.path().string(), temp_ / "root"});
        }
    ASSERT_TRUE(packages.contains("libeventide-core1") && packages.contains("libeventide1") &&
                packages.contains("libeventide-dev") && packages.contains("eventide"));
    const std::string core = field(packages["libeventide-core1"], "Depends");
    EXPECT_NE(core.find("libtbb12"), std::string::npos);
    EXPECT_EQ(core.find("opencv"), std::string::npos) << core;
    EXPECT_NE(field(packages["libeventide1"], "Depends").find("libeventide-core1 (= "),
              std::string::npos);
    EXPECT_NE(field(packages["eventide"], "Depends").find("libavformat"), std::string::npos);
    EXPECT_EQ(field(packages["libeventide-dev"], "Depends"),
              "libeventide1 (= " EVENTIDE_VERSION ")\n");
    const Result version = run({temp_ / "root/usr/bin/eventide", "--version"});
    EXPECT_TRUE(version.output.starts_with("eventide " EVENTIDE_VERSION "\n")) << version.error;
#ifdef EVENTIDE_PYTHON
    EXPECT_NE(field(packages["python3-eventide"], "Depends").find("python3-numpy"),
              std::string::npos);
    expect_frames_of_run(
        {EVENTIDE_PYTHON, example("reconstruct.py")},
        {.environment = {{"PYTHONPATH", temp_ / "root/usr/" EVENTIDE_PYTHON_DIR}}});
#endif
}

}  // namespace
}  // namespace eventide::test
