// --undistort, as a user writes it.
#include "tests/system/program_test.h"

#include <gmock/gmock.h>

#include <string>

namespace eventide::test {
namespace {

using testing::HasSubstr;

constexpr int kWidth = 64, kHeight = 48;

class Undistort : public ProgramTest {
protected:
    void SetUp() override {
        write_text(temp_ / "cam.yaml",
                   "cam0:\n  camera_model: pinhole\n  distortion_model: radtan\n"
                   "  distortion_coeffs: [-0.35, 0.1, 0.001, 0.002]\n"
                   "  intrinsics: [45.0, 45.0, 31.5, 23.5]\n  resolution: [64, 48]\n"
                   "cam1:\n  camera_model: pinhole\n  distortion_model: equidistant\n"
                   "  distortion_coeffs: [0.01, 0.0, 0.0, 0.0]\n"
                   "  intrinsics: [300.0, 300.0, 172.5, 129.5]\n  resolution: [346, 260]\n");
    }
    /// Bytes of gray8 frames; empty where it failed.
    std::string frames(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), {"run", recording(), "--fps", "50", "--duration",
                                             "100ms", "--out", "gray8:-"});
        const Result result = eventide(arguments);
        EXPECT_EQ(result.exit_code, 0) << result.error;
        return result.output;
    }
};

TEST_F(Undistort, TheMiddleStaysAndTheRestMoves) {
    const std::string plain = frames({}), flat = frames({"--undistort", "cam.yaml"});
    ASSERT_EQ(flat.size(), plain.size());
    ASSERT_GE(flat.size(), std::size_t(kWidth * kHeight));
    EXPECT_NE(flat, plain);
    const std::size_t middle = std::size_t(24 * kWidth + 32);
    EXPECT_NEAR(int(std::uint8_t(flat[middle])), int(std::uint8_t(plain[middle])), 2);
    EXPECT_EQ(frames({"--undistort", "cam.yaml", "--sequential"}), flat);
}

TEST_F(Undistort, APartIsThatPartOfTheWholeAtAnySize) {
    const std::string whole = frames({"--undistort", "cam.yaml", "--size", "2x"});
    const std::string part =
        frames({"--undistort", "cam.yaml", "--size", "2x", "--roi", "80,20,40x30"});
    ASSERT_EQ(whole.size() % (4 * kWidth * kHeight), 0U);
    ASSERT_EQ(part.size() / (40 * 30), whole.size() / (4 * kWidth * kHeight));
    for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 40; ++x)
            ASSERT_NEAR(int(std::uint8_t(part[std::size_t(y * 40 + x)])),
                        int(std::uint8_t(whole[std::size_t((20 + y) * 2 * kWidth + 80 + x)])), 1)
                << x << "," << y;
}

TEST_F(Undistort, WhatDoesNotFitIsNamed) {
    const auto refused = [&](const std::vector<std::string>& options, int exit_code) {
        std::vector<std::string> all{"run", recording(), "--out", "a.mp4"};
        all.insert(all.end(), options.begin(), options.end());
        const Result result = eventide(all);
        EXPECT_EQ(result.exit_code, exit_code) << result.error;
        EXPECT_FALSE(std::filesystem::exists(temp_ / "a.mp4"));
        return result.error;
    };
    EXPECT_THAT(refused({"--undistort", "cam.yaml", "--undistort-camera", "cam1"}, 3),
                HasSubstr("--undistort cam.yaml: expected the calibration of a sensor of 64x48, "
                          "found one of 346x260"));
    EXPECT_THAT(refused({"--undistort", "cam.yaml", "--filter", "flip:x"}, 2),
                HasSubstr("expected no --filter flip:x"));
    EXPECT_THAT(refused({"--undistort", "none.yaml"}, 3), HasSubstr("none.yaml"));
    EXPECT_THAT(refused({"--undistort-camera", "cam1"}, 2), HasSubstr("expected --undistort FILE"));
    EXPECT_THAT(refused({"--undistort", "cam.yaml", "--roi", "60,0,40x30"}, 2),
                HasSubstr("--roi 60,0,40x30"));
    write_text(temp_ / "a.mp4", "kept");
    const Result same =
        eventide({"run", recording(), "--undistort", "a.mp4", "--overwrite", "--out", "a.mp4"});
    EXPECT_EQ(same.exit_code, 2);
    EXPECT_THAT(same.error, HasSubstr("is the same file as --undistort"));
    EXPECT_EQ(read_text(temp_ / "a.mp4"), "kept");
}

}  // namespace
}  // namespace eventide::test
