// A colour camera, as a user has it: simulated through a Bayer filter, reconstructed in colour.
#include "tests/system/program_test.h"

#include <gmock/gmock.h>

#include <cmath>
#include <string>

namespace eventide::test {
namespace {

using testing::HasSubstr;

constexpr std::size_t kWidth = 64, kHeight = 48, kPixels = kWidth * kHeight;

/// A 24-bit BMP whose colours go different ways over the image.
std::string colourful_bmp(int number) {
    constexpr int kSide = 64;
    std::string file(54, '\0');
    const auto put = [&](std::size_t at, std::uint32_t value) {
        for (std::size_t i = 0; i < 4; ++i) file[at + i] = char(value >> 8 * i);
    };
    file[0] = 'B', file[1] = 'M';
    put(2, 54 + 3 * kSide * kSide);
    put(10, 54);
    put(14, 40);
    put(18, kSide);
    put(22, kSide);
    put(26, 1 | 24 << 16);
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
            file += char(x / 8 % 2 * 120 + 2 * y);                           // blue
            file += char((x + y) / 16 % 2 * 100 + 2 * ((x + number) % 64));  // green
            file += char(y / 12 % 2 * 150 + (63 - x));                       // red
        }
    return file;
}

class Colour : public ProgramTest {
protected:
    void SetUp() override {
        std::filesystem::create_directory(temp_ / "textures");
        for (int i = 0; i < 4; ++i)
            write_text(temp_ / ("textures/" + std::to_string(i) + ".bmp"), colourful_bmp(i));
    }
    void simulate(const std::string& bayer, const std::string& out) {
        const Result made = eventide({"simulate", "--scene", "demo", "--seconds", "0.2", "--size",
                                      "64x48", "--bayer", bayer, "--textures", "textures", "--out",
                                      out, "--truth", "truth/", "--overwrite"});
        ASSERT_EQ(made.exit_code, 0) << made.error;
    }
    /// Red, green and blue bytes of all frames of a folder.
    std::string pixels(const std::string& folder) const {
        const Result read =
            run({"ffmpeg", "-v", "error", "-i", temp_ / (folder + "/frames/frame_%010d.png"), "-f",
                 "rawvideo", "-pix_fmt", "rgb24", "-"});
        EXPECT_EQ(read.exit_code, 0) << read.error;
        return read.output;
    }
    /// Root mean square of the difference of red and blue from the truth's; `swapped`: from the
    /// other way round.
    static double colour_error(const std::string& found, const std::string& truth, bool swapped) {
        double sum = 0;
        for (std::size_t i = 0; i + 2 < found.size(); i += 3) {
            const int had = int(std::uint8_t(found[i])) - int(std::uint8_t(found[i + 2]));
            const int is = int(std::uint8_t(truth[i])) - int(std::uint8_t(truth[i + 2]));
            sum += std::pow(had - (swapped ? -is : is), 2);
        }
        return std::sqrt(3 * sum / double(found.size()));
    }
};

TEST_F(Colour, OfARecordingThatTellsItsFilter) {
    for (const std::string& recording : {std::string{"grbg.aedat4"}, std::string{"bggr.aedat"}}) {
        simulate(recording.substr(0, 4), recording);
        const Result made = eventide({"run", recording, "--colour", "--frames", "use", "--fps",
                                      "25", "--out", "frames/", "--out", "x.mp4", "--overwrite"});
        ASSERT_EQ(made.exit_code, 0) << made.error;
        EXPECT_THAT(probe(temp_ / "frames/frames/frame_0000000000.png", "pix_fmt"),
                    HasSubstr("rgb24"));
        const std::string found = pixels("frames"), truth = pixels("truth");
        ASSERT_GE(found.size(), 3 * 4 * kPixels);
        const std::string first = found.substr(0, std::min(found.size(), truth.size()));
        EXPECT_LT(2 * colour_error(first, truth, false), colour_error(first, truth, true))
            << recording << ": another order of colours would be as good";
        // The same in another arrangement is the wrong one, and seen to be.
        const Result wrong = eventide({"run", recording, "--colour", "--bayer",
                                       recording.starts_with("grbg") ? "gbrg" : "rggb", "--fps",
                                       "25", "--out", "frames/", "--overwrite"});
        ASSERT_EQ(wrong.exit_code, 0) << wrong.error;
        const std::string bad = pixels("frames").substr(0, first.size());
        EXPECT_GT(colour_error(bad, truth, false), colour_error(bad, truth, true));
    }
}

TEST_F(Colour, LeavesIntensityAndSigmaAsTheyAre) {
    simulate("rggb", "rggb.aedat4");
    const std::vector<std::string> common{"run",         "rggb.aedat4", "--fps",     "25",
                                          "--precision", "f32",         "--kernels", "own",
                                          "--size",      "2x",          "--roi",     "10,8,80x60"};
    auto grey = common, colour = common;
    grey.insert(grey.end(), {"--out", "grey/"});
    colour.insert(colour.end(), {"--colour", "--out", "colour/", "--flip", "none"});
    ASSERT_EQ(eventide(grey).exit_code, 0);
    const Result made = eventide(colour);
    ASSERT_EQ(made.exit_code, 0) << made.error;
    EXPECT_EQ(read_text(temp_ / "grey/uncertainty/unc_0000000003.tiff"),
              read_text(temp_ / "colour/uncertainty/unc_0000000003.tiff"));
    EXPECT_THAT(probe(temp_ / "grey/frames/frame_0000000003.png", "width,height,pix_fmt"),
                HasSubstr("80,60,gray"));
    EXPECT_THAT(probe(temp_ / "colour/frames/frame_0000000003.png", "width,height,pix_fmt"),
                HasSubstr("80,60,rgb24"));
}

TEST_F(Colour, FollowsTheFilterBehindWhatMovesPixels) {
    simulate("rggb", "rggb.aedat4");
    // Mirrored before and after, so that frames are as the truth.
    const auto frames_of = [&](std::vector<std::string> source) {
        source.insert(source.begin(), "run");
        source.insert(source.end(), {"--colour", "--frames", "use", "--fps", "25", "--flip",
                                     "horizontal", "--precision", "f32", "--kernels", "own",
                                     "--out", "frames/", "--overwrite"});
        const Result made = eventide(source);
        EXPECT_EQ(made.exit_code, 0) << made.error;
        return pixels("frames");
    };
    const std::string found = frames_of({"rggb.aedat4", "--filter", "flip:x"});
    const std::string truth = pixels("truth"), first = found.substr(0, truth.size());
    EXPECT_LT(2 * colour_error(first, truth, false), colour_error(first, truth, true));

    // From AEDAT 4 to AEDAT 3 and back: one says it of the sensor, the other of each image.
    std::string from = "rggb.aedat4";
    for (const std::vector<std::string>& step :
         {std::vector<std::string>{"mirrored.aedat4", "--filter", "flip:x"},
          {"again.aedat"},
          {"back.aedat4"}}) {
        std::vector<std::string> convert{"convert", from};
        convert.insert(convert.end(), step.begin(), step.end());
        ASSERT_EQ(eventide(convert).exit_code, 0) << step.front();
        from = step.front();
        EXPECT_TRUE(frames_of({from}) == found) << from;
    }
}

TEST_F(Colour, IsMissedWhereAFormatCannotSayIt) {
    simulate("gbrg", "gbrg.aedat4");
    const auto converted = [&](const char* to) {
        return eventide({"convert", "gbrg.aedat4", to, "--strict"});
    };
    for (const char* to : {"a.h5", "folder/"}) {
        const Result made = converted(to);
        EXPECT_EQ(made.exit_code, 5) << to;
        EXPECT_THAT(made.error, HasSubstr("colour filter, gbrg: --bayer states it"));
    }
    for (const char* to : {"a.aedat", "b.aedat4"})
        EXPECT_EQ(converted(to).exit_code, 0) << to << ": it says it";

    const Result recorded = eventide({"run", "a.aedat", "--out", "null", "--record", "b.h5",
                                      "--events-out", "events/", "--strict"});
    EXPECT_EQ(recorded.exit_code, 5);
    for (const char* to : {"b.h5", "events/"})
        EXPECT_THAT(recorded.error,
                    HasSubstr(std::string{to} + ": its format cannot say the images' colour"));
    const Result simulated = eventide({"simulate", "--seconds", ".1", "--size", "64x48", "--bayer",
                                       "rggb", "--textures", "textures", "--out", "simulated/"});
    EXPECT_EQ(simulated.exit_code, 0);
    EXPECT_THAT(simulated.error, HasSubstr("colour filter, rggb: --bayer states it"));
}

TEST_F(Colour, IsKeptByARecordingOfARecording) {
    simulate("gbrg", "gbrg.aedat");
    ASSERT_EQ(eventide({"run", "gbrg.aedat", "--out", "null", "--record", "gbrg.aedat4"}).exit_code,
              0);
    const Result made = eventide({"run", "gbrg.aedat4", "--colour", "--out", "null"});
    EXPECT_EQ(made.exit_code, 0) << made.error;
}

TEST_F(Colour, GoesOnFromAStateWithTheColours) {
    simulate("rggb", "rggb.aedat4");
    const auto frames_of = [&](std::vector<std::string> more) {
        std::vector<std::string> all{"run",    "rggb.aedat4", "--colour", "--frames",
                                     "ignore", "--window",    "10ms",     "--fps",
                                     "50",     "--precision", "f32",      "--kernels",
                                     "own",    "--out",       "frames/",  "--overwrite"};
        all.insert(all.end(), more.begin(), more.end());
        const Result made = eventide(all);
        EXPECT_EQ(made.exit_code, 0) << made.error;
        return pixels("frames");
    };
    // The four frames behind the first of the second half.
    const auto tail = [](const std::string& found) {
        return found.substr(found.size() - 4 * 3 * kPixels);
    };
    const std::string whole = tail(frames_of({}));
    frames_of({"--to", "100ms", "--state-out", "state"});
    const auto difference = [&](std::vector<std::string> more) {
        more.insert(more.end(), {"--from", "100ms"});
        const std::string found = tail(frames_of(more));
        double sum = 0;
        for (std::size_t i = 0; i < whole.size(); ++i)
            sum += std::abs(int(std::uint8_t(found[i])) - int(std::uint8_t(whole[i])));
        return sum / double(whole.size());
    };
    EXPECT_LT(2 * difference({"--state-in", "state"}), difference({"--warmup", "0s"}));

    const auto refused = [&](std::vector<std::string> more) {
        more.insert(more.begin(), {"run", "rggb.aedat4", "--out", "null"});
        const Result result = eventide(more);
        EXPECT_EQ(result.exit_code, 3) << result.error;
        return result.error;
    };
    EXPECT_THAT(refused({"--state-in", "state"}),
                HasSubstr("state: expected the state of a run without colours, found that of one "
                          "with those of rggb (--colour)"));
    EXPECT_THAT(refused({"--state-in", "state", "--colour", "--bayer", "bggr"}),
                HasSubstr("expected the state of a run with those of bggr"));
    ASSERT_EQ(eventide({"run", "rggb.aedat4", "--out", "null", "--state-out", "grey"}).exit_code,
              0);
    EXPECT_THAT(refused({"--state-in", "grey", "--colour"}),
                HasSubstr("found that of one without colours"));
}

TEST_F(Colour, WhatHasNoneIsNamed) {
    simulate("rggb", "rggb.aedat4");
    const auto refused = [&](std::vector<std::string> options) {
        options.insert(options.begin(), {"run", "rggb.aedat4", "--colour"});
        const Result result = eventide(options);
        EXPECT_EQ(result.exit_code, 2) << result.error;
        return result.error;
    };
    for (const std::string sink :
         {"gray8:a", "y4m-mono:a", "x.gif", "ros2:/x", "v4l2:/dev/video99"})
        EXPECT_THAT(refused({"--out", sink}), HasSubstr("--out " + sink + ": has no colour"));
    EXPECT_THAT(refused({"--out", "null", "--bayer", "none"}),
                HasSubstr("--colour: expected a camera or recording that tells its colour filter"));
    EXPECT_THAT(refused({"--out", "null", "--filter", "subsample:2x2"}),
                HasSubstr("--filter subsample:2x2: leaves no square of colours of the rggb"));
    const Result grey = eventide({"run", recording(), "--colour", "--out", "null"});
    EXPECT_EQ(grey.exit_code, 2);
    const Result plain =
        eventide({"simulate", "--bayer", "rggb", "--seconds", ".1", "--out", "a.aedat4"});
    EXPECT_EQ(plain.exit_code, 2);
    EXPECT_THAT(plain.error, HasSubstr("expected --textures and a folder of colour images"));
}

}  // namespace
}  // namespace eventide::test
