// The installed libraries as their users find them: by CMake, pkg-config and Python, wherever they
// lie.
#include "tests/library/installed_test.h"

#include <filesystem>

namespace eventide::test {
namespace {

namespace fs = std::filesystem;

TEST_F(Installed, FindPackageGivesAProgramTheSameFrames) {
    succeed({EVENTIDE_CMAKE, "-S", example(""), "-B", temp_ / "build",
             "-DCMAKE_PREFIX_PATH=" + prefix()});
    succeed({EVENTIDE_CMAKE, "--build", temp_ / "build"});
    expect_frames_of_run({temp_ / "build/reconstruct"});
    const Result full = run({temp_ / "build/reconstruct", recording(), "/dev/full"});
    EXPECT_EQ(full.exit_code, 1);
    EXPECT_NE(full.error.find("/dev/full: cannot be written"), std::string::npos) << full.error;
    const Result tracked =
        run({temp_ / "build/tracker", recording()}, {.environment = {{"EVENTIDE_MODELS", ""}}});
    EXPECT_EQ(tracked.exit_code, 0) << tracked.error;
    EXPECT_NE(tracked.output.find("the centre moves by"), std::string::npos) << tracked.output;
    const Result own =
        run({temp_ / "build/own_source"}, {.environment = {{"EVENTIDE_MODELS", ""}}});
    EXPECT_NE(own.output.find("189999 us: "), std::string::npos) << own.output << own.error;
    expect_frames_of_text_with_the_core_alone(temp_ / "build/from_text");
}

TEST_F(Installed, StaticLibrariesGiveAProgramTheSameFrames) {
    succeed({EVENTIDE_CMAKE, "-S", example(""), "-B", temp_ / "build",
             "-DCMAKE_PREFIX_PATH=" + prefix(), "-Deventide_USE_STATIC_LIBS=ON",
             "-DCMAKE_DISABLE_FIND_PACKAGE_OpenCV=ON"});
    succeed({EVENTIDE_CMAKE, "--build", temp_ / "build"});
    EXPECT_EQ(libraries_of(temp_ / "build/reconstruct").find("libeventide"), std::string::npos);
    const ProcessSettings models{
        .environment = {{"EVENTIDE_MODELS", prefix() + "/share/eventide/models"}}};
    expect_frames_of_run({temp_ / "build/reconstruct"}, models);
    expect_frames_of_text_with_the_core_alone(temp_ / "build/from_text");
}

/// Where the static libraries are all there is.
TEST_F(Installed, PkgConfigTellsWhatStaticLibrariesNeed) {
    const std::string only = temp_ / "eventide";
    fs::copy(prefix(), only, fs::copy_options::recursive | fs::copy_options::copy_symlinks);
    const std::string folder = only + "/" EVENTIDE_LIBDIR;
    for (const auto& entry : fs::directory_iterator{folder})
        if (entry.path().filename().string().find(".so") != std::string::npos)
            fs::remove(entry.path());
    fs::remove(folder + "/cmake/eventide/eventideShared.cmake");
    succeed({"sh", "-c",
             "cc -std=c11 -Werror " + example("reconstruct.c") + " -o " + (temp_ / "reconstruct") +
                 " $(pkg-config --static --cflags --libs eventide)"},
            {.environment = {{"PKG_CONFIG_PATH", folder + "/pkgconfig"}}});
    EXPECT_EQ(libraries_of(temp_ / "reconstruct").find("libeventide"), std::string::npos);
    expect_frames_of_run({temp_ / "reconstruct"},
                         {.environment = {{"EVENTIDE_MODELS", only + "/share/eventide/models"}}});
}

TEST_F(Installed, ComponentThatIsNotThereIsRefusedByName) {
    write_text(temp_ / "CMakeLists.txt",
               "cmake_minimum_required(VERSION 3.25)\nproject(asks LANGUAGES CXX)\n"
               "find_package(eventide 1 REQUIRED COMPONENTS core teleport)\n");
    const Result result = run({EVENTIDE_CMAKE, "-S", temp_.path().string(), "-B", temp_ / "build",
                               "-DCMAKE_PREFIX_PATH=" + prefix()});
    EXPECT_NE(result.exit_code, 0);
    EXPECT_NE(result.error.find("component 'teleport'"), std::string::npos) << result.error;
    EXPECT_NE(result.error.find("(core,"), std::string::npos) << result.error;
}

TEST_F(Installed, PkgConfigGivesAProgramInCTheSameFrames) {
    const ProcessSettings where{
        .environment = {{"PKG_CONFIG_PATH", library_folder() + "/pkgconfig"}}};
    const Result version = run({"pkg-config", "--modversion", "eventide"}, where);
    EXPECT_EQ(version.output, EVENTIDE_VERSION "\n") << version.error;
    succeed({"sh", "-c",
             "cc -std=c11 -Wall -Wextra -Wpedantic -Werror " + example("reconstruct.c") + " -o " +
                 (temp_ / "reconstruct") + " $(pkg-config --cflags --libs eventide)"},
            where);
    const ProcessSettings with{.environment = {{"LD_LIBRARY_PATH", library_folder()}}};
    expect_frames_of_run({temp_ / "reconstruct"}, with);
    EXPECT_EQ(run({temp_ / "reconstruct", recording(), "/dev/full"}, with).exit_code, 1);
    EXPECT_EQ(run({temp_ / "reconstruct", temp_ / "nothing", temp_ / "ours"}, with).exit_code, 1);
    EXPECT_NE(read_text(temp_ / "ours"), "") << "what no recording takes the place of stays";
}

TEST_F(Installed, PythonGivesTheSameFrames) {
#ifdef EVENTIDE_PYTHON
    expect_frames_of_run({EVENTIDE_PYTHON, example("reconstruct.py")},
                         {.environment = {{"PYTHONPATH", prefix() + "/" EVENTIDE_PYTHON_DIR}}});
#else
    GTEST_SKIP() << "built without EVENTIDE_PYTHON";
#endif
}

}  // namespace
}  // namespace eventide::test
