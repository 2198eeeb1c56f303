// The installed tree as its users have it: found by CMake, pkg-config and Python, wherever it lies.
#include "tests/system/program_test.h"

#include <filesystem>
#include <map>
#include <memory>
#include <regex>
#include <sstream>

namespace eventide::test {
namespace {

namespace fs = std::filesystem;

class Installed : public ProgramTest {
protected:
    /// Installed somewhere, and moved from there.
    static void SetUpTestSuite() {
        ProgramTest::SetUpTestSuite();
        place_ = std::make_unique<TempFolder>();
        const Result made =
            run({EVENTIDE_CMAKE, "--install", EVENTIDE_BUILD_DIR, "--prefix", *place_ / "first"});
        ASSERT_EQ(made.exit_code, 0) << made.error;
        fs::rename(*place_ / "first", *place_ / "eventide");
    }
    static void TearDownTestSuite() { place_.reset(); }

    static std::string prefix() { return *place_ / "eventide"; }
    static std::string library_folder() { return prefix() + "/" EVENTIDE_LIBDIR; }
    static std::string example(const std::string& name) {
        return EVENTIDE_SOURCE_DIR "/examples/" + name;
    }

    void succeed(const std::vector<std::string>& command, ProcessSettings settings = {}) const {
        const Result result = run(command, std::move(settings));
        ASSERT_EQ(result.exit_code, 0) << command.front() << "\n" << result.output << result.error;
    }

    /// The example writes what `eventide run` does, with the installed default model.
    void expect_frames_of_run(std::vector<std::string> example,
                              ProcessSettings settings = {}) const {
        example.insert(example.end(), {recording(), temp_ / "ours"});
        settings.environment.try_emplace("EVENTIDE_MODELS", "");
        succeed(example, settings);
        expect_ours_of_run({recording()});
    }

    /// from_text writes what `eventide run` does of the same file, and loads nothing but the core.
    void expect_frames_of_text_with_the_core_alone(const std::string& from_text) const {
        const Result text = eventide({"convert", recording(), "events.txt"});
        ASSERT_EQ(text.exit_code, 0) << text.error;
        succeed({from_text, temp_ / "events.txt", temp_ / "ours"},
                {.environment = {{"EVENTIDE_MODELS", prefix() + "/share/eventide/models"}}});
        expect_ours_of_run({"events.txt"});
        write_text(temp_ / "damaged.txt", "64 48\n0.1 1 2 1\n0.2 one 2 1\n0.3 1 2 1\n");
        const Result damaged =
            run({from_text, temp_ / "damaged.txt", temp_ / "ours"},
                {.environment = {{"EVENTIDE_MODELS", prefix() + "/share/eventide/models"}}});
        EXPECT_EQ(damaged.exit_code, 1);
        EXPECT_EQ(damaged.error, temp_ / "damaged.txt" +
                                     ": expected events \"t x y p\", found a line that is none\n");
        const std::string loaded = libraries_of(from_text);
        for (const char* const package : {"libopencv", "libusb", "liblz4", "libeventide.so"})
            EXPECT_EQ(loaded.find(package), std::string::npos) << loaded;
    }

    void expect_ours_of_run(const std::vector<std::string>& source) const {
        std::vector<std::string> arguments{"run"};
        arguments.insert(arguments.end(), source.begin(), source.end());
        arguments.insert(arguments.end(),
                         {"--model", prefix() + "/share/eventide/models/default.safetensors",
                          "--precision", "f32", "--out", "grayf32:theirs", "--overwrite",
                          "--uncertainty", "separate", "--sigma-white", "1"});
        const Result theirs = eventide(arguments);
        ASSERT_EQ(theirs.exit_code, 0) << theirs.error;
        const std::string frames = read_text(temp_ / "ours");
        EXPECT_GE(frames.size(), 12U * 64 * 48 * 8);
        EXPECT_TRUE(frames == read_text(temp_ / "theirs"));
    }

    /// What a program loads, as ldd says.
    static std::string libraries_of(const std::string& program) {
        const Result result = run({"ldd", program});
        EXPECT_EQ(result.exit_code, 0) << result.error;
        return result.output;
    }

    inline static std::unique_ptr<TempFolder> place_;
};

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

TEST_F(Installed, PythonGivesTheSameFrames) {
#ifdef EVENTIDE_PYTHON
    expect_frames_of_run({EVENTIDE_PYTHON, example("reconstruct.py")},
                         {.environment = {{"PYTHONPATH", prefix() + "/" EVENTIDE_PYTHON_DIR}}});
#else
    GTEST_SKIP() << "built without EVENTIDE_PYTHON";
#endif
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

TEST_F(Installed, HeadersCompileAloneAndWithEveryWarning) {
    for (const auto& entry : fs::directory_iterator{prefix() + "/include/eventide"}) {
        const std::string header = entry.path().filename().string();
        write_text(temp_ / "alone.cpp", "#include <eventide/" + header + ">\nint main() {}\n");
        succeed({"c++", "-std=c++20", "-fsyntax-only", "-Wall", "-Wextra", "-Wpedantic",
                 "-Wconversion", "-Wshadow", "-Werror", "-I", prefix() + "/include",
                 temp_ / "alone.cpp"});
    }
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
