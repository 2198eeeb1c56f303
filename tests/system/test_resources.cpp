// What the machine refuses: memory, space, file descriptors, a standard stream. Each is said, by
// name, with exit code 1.
#include "tests/system/program_test.h"

#include <csignal>
#include <filesystem>

namespace eventide::test {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

class Resources : public ProgramTest {};

/// With so much address space.
Result with_memory(int mebibytes, const std::vector<std::string>& arguments,
                   const std::string& folder) {
    std::vector<std::string> all{"bash", "-c", "ulimit -v $0 && exec \"$@\"",
                                 std::to_string(mebibytes * 1024), EVENTIDE_PROGRAM};
    all.insert(all.end(), arguments.begin(), arguments.end());
    ProcessSettings settings;
    settings.folder = folder;
    return run(all, std::move(settings));
}

TEST_F(Resources, OneIsTooLittleMemoryAndItIsSaidBeforeTheFirstFrame) {
    if (kSanitized) GTEST_SKIP() << "sanitizers take all the address space there is";
    write_text(temp_ / "large.raw", "% evt 3.0\n% geometry 4096x4096\n% end\n");
    const std::string folder = temp_.path().string();
    const Result large =
        with_memory(3000, {"run", "large.raw", "--model", model(), "--out", "a/"}, folder);
    EXPECT_EQ(large.exit_code, 1) << large.error;
    EXPECT_NE(large.error.find("for a sensor of 4096x4096 wants at least"), std::string::npos)
        << large.error;
    EXPECT_FALSE(std::filesystem::exists(temp_ / "a"));
    const Result wide = with_memory(
        3000, {"run", recording(), "--model", model(), "--size", "16384x16384", "--out", "null"},
        folder);
    EXPECT_EQ(wide.exit_code, 1) << wide.error;
    EXPECT_NE(wide.error.find("a frame of 16384x16384 (--size, --roi) for a sensor of 64x48 wants "
                              "at least 20"),
              std::string::npos)
        << wide.error;
}

/// The shipped network at a real sensor's size: libraries that make code and threads are in it.
/// With less than they need to be loaded, one of them aborts before main().
TEST_F(Resources, WithWhateverMemoryARunNeitherHangsNorCrashes) {
    if (kSanitized) GTEST_SKIP() << "sanitizers take all the address space there is";
    write_text(temp_ / "real.raw", "% evt 3.0\n% geometry 346x260\n% end\n");
    for (int mebibytes = 450; mebibytes <= 700; mebibytes += 25) {
        const Result result =
            with_memory(mebibytes,
                        {"run", "real.raw", "--model",
                         EVENTIDE_SOURCE_DIR "/config/models/default.safetensors", "--out", "null"},
                        temp_.path().string());
        EXPECT_NE(result.exit_code, 128 + SIGSEGV) << mebibytes << " MiB: " << result.error;
    }
}

TEST_F(Resources, OneIsFailureWhileRunning) {
    expect(1, {"run", recording(), "--out", "gray8:/dev/full"}, "/dev/full");
    expect(1, {"run", recording(), "--out", "/proc/nowhere/"}, "/proc/nowhere");
    expect(1, {"run", recording(), "--out", "null", "--stats", "/dev/full"}, "/dev/full");
    std::filesystem::create_symlink("/dev/full", temp_ / "full.raw");
    expect(1, {"run", recording(), "--out", "null", "--record", "full.raw"}, "full.raw");
}

TEST_F(Resources, OneIsStandardOutputThatCannotBeWritten) {
    for (const char* command :
         {"info recording", "info model.safetensors", "devices --json", "doctor",
          "run --print-config", "simulate --list", "evaluate recording --json -",
          "bench --seconds 0.2 --sizes 16x16", "stress --quick --cases one-event --models default",
          "--help", "run --help", "--version", "--default-config"}) {
        const Result full = in_shell(std::string{"eventide "} + command + " > /dev/full");
        EXPECT_EQ(full.exit_code, 1) << command << "\n" << full.error;
        EXPECT_NE(full.error.find("standard output: cannot be written: No space left on device"),
                  std::string::npos)
            << command << "\n"
            << full.error;
        EXPECT_EQ(in_shell(std::string{"eventide "} + command + " | true").exit_code, 0)
            << command << ": a reader that goes away is no error";
    }
}

TEST_F(Resources, OneIsAFileThatMayNotGrow) {
    for (const char* command :
         {"run recording --out a.mp4", "run recording --out a/", "run recording --out gray8:a.raw",
          "run recording --out null --record a.aedat4", "convert recording c.aedat4",
          "simulate --seconds 0.3 --out b/"}) {
        const Result result = in_shell(std::string{"ulimit -f 1; eventide "} + command);
        EXPECT_EQ(result.exit_code, 1) << command << "\n" << result.error;
        EXPECT_NE(result.error.find("cannot be written"), std::string::npos) << result.error;
    }
}

TEST_F(Resources, OneIsAProcessWithoutFileDescriptors) {
    const auto said = [&](int descriptors, const std::string& command) {
        const Result result = in_shell("ulimit -n " + std::to_string(descriptors) +
                                       "; exec eventide " + command + " --overwrite");
        const bool told = result.error.find("ulimit -n") != std::string::npos;
        EXPECT_TRUE(result.exit_code == 0 || (result.exit_code == 1 && told))
            << descriptors << ", " << command << ": " << result.exit_code << "\n"
            << result.error;
        return told;
    };
    int refused = 0;
    for (int n = 5; n < 16; ++n) {
        refused += said(n, "run recording --out a/ --out b.mp4 --stats s --state-out t");
        refused += said(n, "convert recording c.aedat4");
    }
    EXPECT_GT(refused, 4);
}

TEST_F(Resources, AClosedStandardStreamGetsNoFile) {
    EXPECT_EQ(in_shell("eventide run recording --out gray8:a 2>&- >&-").exit_code, 0);
    EXPECT_EQ(read_text(temp_ / "a").size() % (64 * 48), 0U);
    EXPECT_EQ(in_shell("eventide info recording >&-").exit_code, 1);
}

}  // namespace
}  // namespace eventide::test
