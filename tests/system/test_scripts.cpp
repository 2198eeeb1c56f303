// scripts/ as they are called from another folder than the project's.
#include "tests/system/program_test.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace eventide::test {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
namespace fs = std::filesystem;

class Scripts : public ProgramTest {
protected:
    Scripts() { fs::create_directory_symlink(EVENTIDE_SOURCE_DIR, temp_ / "project"); }
    Result script(const std::string& name, std::vector<std::string> arguments,
                  std::map<std::string, std::string> environment = {}) const {
        arguments.insert(arguments.begin(), {"bash", "project/scripts/" + name});
        return run(arguments,
                   {.environment = std::move(environment), .folder = temp_.path().string()});
    }
};

TEST_F(Scripts, SayHowTheyAreCalled) {
    for (const std::string name :
         {"accuracy.sh", "conditions.sh", "experiments.sh", "moving_picture.sh", "train.sh"}) {
        const Result result = script(name, {});
        EXPECT_EQ(result.exit_code, 2) << name;
        EXPECT_THAT(result.error, HasSubstr("scripts/" + name + " ")) << name;
    }
}

/// Elsewhere bash writes and awk reads "1,5".
TEST_F(Scripts, CalculateWithDecimalPointsInEveryCountry) {
    int calculating = 0;
    for (const auto& file : fs::recursive_directory_iterator{EVENTIDE_SOURCE_DIR "/scripts"}) {
        if (file.path().extension() != ".sh") continue;
        const std::string text = read_text(file.path());
        if (text.find("awk ") == std::string::npos) continue;
        ++calculating;
        EXPECT_THAT(text, AnyOf(HasSubstr("export LC_ALL=C "), HasSubstr("/common.sh\"")))
            << file.path();
    }
    EXPECT_GE(calculating, 7);
}

TEST_F(Scripts, TakePathsFromTheFolderOneIsIn) {
    fs::create_directory(temp_ / "bin");
    write_text(temp_ / "bin/ffmpeg", "#!/bin/sh\nfor last; do :; done\necho made > \"$last\"\n");
    fs::permissions(temp_ / "bin/ffmpeg", fs::perms::owner_all);
    write_text(temp_ / "recording.txt", "64 48\n0.001 1 1 1\n0.2 2 2 0\n");
    const Result result = script("moving_picture.sh", {"recording.txt", "picture.webp"},
                                 {{"EVENTIDE", EVENTIDE_PROGRAM},
                                  {"EVENTIDE_MODELS", fs::path{model()}.parent_path().string()},
                                  {"PATH", temp_ / "bin:" + std::getenv("PATH")}});
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_EQ(read_text(temp_ / "picture.webp"), "made\n");
}

}  // namespace
}  // namespace eventide::test
