// scripts/ as they are called from another folder than the project's.
#include "tests/system/program_test.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace eventide::test {
namespace {

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

/// Those of a folder that are called: what they share is not.
std::vector<std::string> called_scripts() {
    const fs::path folder = EVENTIDE_SOURCE_DIR "/scripts";
    std::vector<std::string> found;
    for (const auto& file : fs::recursive_directory_iterator{folder})
        if (file.path().extension() == ".sh" && file.path().filename() != "common.sh")
            found.push_back(fs::relative(file.path(), folder));
    return found;
}

TEST_F(Scripts, SayHowTheyAreCalled) {
    const std::vector<std::string> scripts = called_scripts();
    EXPECT_GE(scripts.size(), 15U);
    for (const std::string& name : scripts) {
        const Result result = script(name, {"--help"});
        EXPECT_EQ(result.exit_code, 0) << name;
        EXPECT_THAT(result.output, HasSubstr(fs::path{name}.filename().string())) << name;
    }
    for (const std::string name : {"accuracy.sh", "conditions.sh", "experiments.sh", "fuzz.sh",
                                   "moving_picture.sh", "tracker_noise.sh", "train.sh"}) {
        const Result result = script(name, {});
        EXPECT_EQ(result.exit_code, 2) << name;
        EXPECT_THAT(result.error, HasSubstr("scripts/" + name + " ")) << name;
    }
}

TEST_F(Scripts, ThatInPythonSaysHowItIsCalled) {
    const std::string name = "check-trainer-alone.py";
    const auto called = [&](const char* argument) {
        return run({"python3", "project/scripts/" + name, argument}, {.folder = temp_.path()});
    };
    const Result help = called("--help");
    EXPECT_EQ(help.exit_code, 0) << help.error;
    EXPECT_THAT(help.output, HasSubstr("scripts/" + name));
    const Result wrong = called("quick");
    EXPECT_EQ(wrong.exit_code, 2);
    EXPECT_THAT(wrong.error, HasSubstr("scripts/" + name));
}

/// Before they install, build or write anything.
TEST_F(Scripts, RefuseWhatTheyCannotUse) {
    struct Refusal {
        std::string name;
        std::vector<std::string> arguments;
        std::string message;
        std::map<std::string, std::string> environment = {};
    };
    const std::vector<Refusal> refusals{
        {"accuracy.sh", {"nowhere"}, "expected nowhere/recordings, found none"},
        {"conditions.sh", {"nowhere"}, "expected nowhere/images/bsds500, found none"},
        {"experiments.sh", {"nowhere"}, "expected nowhere/recordings, found none"},
        {"train.sh", {".", "soon"}, "MINUTES: expected a whole number above 0, found 'soon'"},
        {"train.sh", {".", "0"}, "MINUTES: expected a whole number above 0, found '0'"},
        {"train.sh", {"nowhere", "5"}, "expected nowhere/perceptual/lpips_squeeze_v0.1.npz"},
        {"moving_picture.sh",
         {"a.raw", "b.webp"},
         "expected the program " + temp_ / "none" + " (",
         {{"EVENTIDE", "./none"}}},
        {"tracker_noise.sh", {"none"}, "found none", {{"EVENTIDE", EVENTIDE_PROGRAM}}},
        {"fuzz.sh", {"soon"}, "SECONDS: expected a whole number above 0, found 'soon'"},
        {"faults.sh", {"many"}, "MOMENTS: expected a whole number above 0, found 'many'"},
        {"check.sh", {"tidy", "teh"}, "found 'teh'"},
        {"check-format.sh", {"--fxi"}, "expected --fix or nothing, found '--fxi'"},
        {"check-arm.sh", {"fast"}, "scripts/check-arm.sh"},
        {"install-packages.sh", {"--test"}, "expected --tests or nothing, found '--test'"},
        {"demo.sh", {"--out"}, "expected a folder, found '--out'"},
        {"test.sh", {"release"}, "found 'release'"},
    };
    for (const Refusal& refusal : refusals) {
        const Result result = script(refusal.name, refusal.arguments, refusal.environment);
        EXPECT_EQ(result.exit_code, 2) << refusal.name;
        EXPECT_THAT(result.error, HasSubstr(refusal.message)) << refusal.name;
    }
}

/// What a program of a measurement says when it fails would else be in a file of the results alone.
TEST_F(Scripts, ShowWhyAMeasurementFailed) {
    fs::remove(temp_ / "project");  // in a project of its own, as it writes into it
    fs::create_directory(temp_ / "project");
    fs::copy(EVENTIDE_SOURCE_DIR "/scripts", temp_ / "project/scripts",
             fs::copy_options::recursive);
    for (const char* folder : {"recordings", "images/bsds500", "perceptual"})
        fs::create_directories(fs::path{temp_ / "data"} / folder);
    write_text(temp_ / "data/perceptual/lpips_squeeze_v0.1.npz", "");
    write_text(temp_ / "program", "#!/bin/sh\necho no such recording >&2\nexit 3\n");
    fs::permissions(temp_ / "program", fs::perms::owner_all);
    write_text(temp_ / "model.safetensors", "for this test alone");
    const Result result =
        script("accuracy.sh", {"data", "model.safetensors", "real"}, {{"EVENTIDE", "./program"}});
    EXPECT_NE(result.exit_code, 0);
    EXPECT_THAT(result.error, HasSubstr("no such recording"));
}

/// Elsewhere bash writes and awk reads "1,5".
TEST_F(Scripts, CalculateWithDecimalPointsInEveryCountry) {
    int calculating = 0;
    for (const auto& file : fs::recursive_directory_iterator{EVENTIDE_SOURCE_DIR "/scripts"}) {
        if (file.path().extension() != ".sh") continue;
        const std::string text = read_text(file.path());
        if (text.find("awk ") == std::string::npos) continue;
        ++calculating;
        EXPECT_THAT(text, HasSubstr("/common.sh\"")) << file.path();
    }
    EXPECT_GE(calculating, 7);
    EXPECT_THAT(read_text(EVENTIDE_SOURCE_DIR "/scripts/common.sh"), HasSubstr("LC_ALL=C"));
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
