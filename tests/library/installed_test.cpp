#include "tests/library/installed_test.h"

#include <filesystem>
#include <utility>

namespace eventide::test {

void Installed::SetUpTestSuite() {
    ProgramTest::SetUpTestSuite();
    place_ = std::make_unique<TempFolder>();
    const Result made =
        run({EVENTIDE_CMAKE, "--install", EVENTIDE_BUILD_DIR, "--prefix", *place_ / "first"});
    ASSERT_EQ(made.exit_code, 0) << made.error;
    std::filesystem::rename(*place_ / "first", *place_ / "eventide");
}

void Installed::succeed(const std::vector<std::string>& command, ProcessSettings settings) {
    const Result result = run(command, std::move(settings));
    ASSERT_EQ(result.exit_code, 0) << command.front() << "\n" << result.output << result.error;
}

void Installed::expect_frames_of_run(std::vector<std::string> example,
                                     ProcessSettings settings) const {
    example.insert(example.end(), {recording(), temp_ / "ours"});
    settings.environment.try_emplace("EVENTIDE_MODELS", "");
    succeed(example, settings);
    expect_ours_of_run({recording()});
}

void Installed::expect_frames_of_text_with_the_core_alone(const std::string& from_text) const {
    const Result text = eventide({"convert", recording(), "events.txt"});
    ASSERT_EQ(text.exit_code, 0) << text.error;
    const ProcessSettings models{
        .environment = {{"EVENTIDE_MODELS", prefix() + "/share/eventide/models"}}};
    succeed({from_text, temp_ / "events.txt", temp_ / "ours"}, models);
    expect_ours_of_run({"events.txt"});
    write_text(temp_ / "damaged.txt", "64 48\n0.1 1 2 1\n0.2 one 2 1\n0.3 1 2 1\n");
    const Result damaged = run({from_text, temp_ / "damaged.txt", temp_ / "ours"}, models);
    EXPECT_EQ(damaged.exit_code, 1);
    EXPECT_EQ(damaged.error,
              temp_ / "damaged.txt" + ": expected events \"t x y p\", found a line that is none\n");
    const std::string loaded = libraries_of(from_text);
    for (const char* const package : {"libopencv", "libusb", "liblz4", "libeventide.so"})
        EXPECT_EQ(loaded.find(package), std::string::npos) << loaded;
}

void Installed::expect_ours_of_run(const std::vector<std::string>& source) const {
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

std::string Installed::libraries_of(const std::string& program) {
    const Result result = run({"ldd", program});
    EXPECT_EQ(result.exit_code, 0) << result.error;
    return result.output;
}

}  // namespace eventide::test
