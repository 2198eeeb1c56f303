// Videos: every frame with its exact time, in files that survive a killed program.
#include "pipeline/sinks/raw_stream.h"
#include "pipeline/sinks/video/video.h"
#include "pipeline/sinks/video/video_kind.h"
#include "src/core/error.h"
#include "tests/pipeline/sinks/frames.h"
#include "tests/pipeline/sinks/probed_video.h"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <filesystem>

namespace eventide {
namespace {

using test::packet_times;
using test::probe;
using test::TempFolder;

TEST(Video, IsNamedInSmallOrLargeLetters) {
    EXPECT_TRUE(names_video("a.mp4"));
    EXPECT_TRUE(names_video("A.MKV"));
    EXPECT_FALSE(names_video("a.mp5"));
}

TEST(VideoSink, KeepsEachFramesTimeToTheMicrosecond) {
    const TempFolder temp;
    VideoSink sink{{.path = temp / "a.mp4", .fps = 300}};
    std::vector<std::int64_t> expected;
    for (int n = 0; n < 100; ++n) {
        sink.write(test::ramp_frame(64, 48, n, test::odd_time(n)));
        expected.push_back((test::odd_time(n) - test::odd_time(0)).count());
    }
    sink.close();
    EXPECT_EQ(
        probe(temp / "a.mp4",
              {"-count_frames", "-show_entries",
               "stream=codec_name,width,height,pix_fmt,color_range,color_space,color_transfer,"
               "color_primaries,time_base,nb_read_frames"}),
        "h264,64,48,yuv420p,tv,bt709,bt709,bt709,1/1000000,100\n");
    EXPECT_EQ(packet_times(temp / "a.mp4"), expected);
}

TEST(VideoSink, AReaderThatGoesAwayIsToldOnceAndIsNoError) {
    signal(SIGPIPE, SIG_IGN);
    const TempFolder temp;
    const std::string pipe = temp / "pipe.gif";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
    int told = 0;
    VideoSink sink{{.path = pipe, .unread = [&](const std::string& name, PipeReader why) {
                        ++told;
                        EXPECT_EQ(name, pipe);
                        EXPECT_EQ(why, PipeReader::left);
                    }}};
    sink.write(test::ramp_frame(8, 8, 0, from_us(0)));
    EXPECT_TRUE(sink.is_watched());
    close(reader);
    for (int i = 1; i < 4; ++i) sink.write(test::ramp_frame(8, 8, i, from_us(100'000 * i)));
    EXPECT_EQ(told, 1);
    EXPECT_FALSE(sink.is_watched());
    sink.close();
}

TEST(VideoSink, SlowMotionShowsFramesLaterInProportion) {
    const TempFolder temp;
    VideoSink sink{{.path = temp / "a.mp4", .fps = 30, .slow = 10}};
    // The sensor's clock goes back once: the video goes on after one frame's length.
    for (const std::int64_t us : {5'000'000, 5'003'333, 5'006'667, 1'000'000, 1'003'333})
        sink.write(test::ramp_frame(64, 48, 0, from_us(us)));
    sink.close();
    EXPECT_EQ(packet_times(temp / "a.mp4"),
              (std::vector<std::int64_t>{0, 33'330, 66'670, 100'003, 133'333}));
}

TEST(VideoSink, EventsStandLeftOfTheFrameWhereTheyAreAskedFor) {
    const TempFolder temp;
    Frame frame = test::ramp_frame(32, 16, 3, from_us(0));
    frame.event_preview = Array2<float>{8, 16};  // half the frame's size
    frame.event_preview(0, 0) = 1;
    frame.event_preview(7, 15) = -1;
    for (const bool events : {false, true}) {
        VideoSink sink{{.path = temp / "a.gif", .overwrite = true, .events = events}};
        sink.write(frame);
        sink.close();
        const std::string size = events ? "64,16\n" : "32,16\n";
        EXPECT_EQ(probe(temp / "a.gif", {"-show_entries", "stream=width,height"}), size);
    }
    const test::Result pixels =
        test::run({"ffmpeg", "-v", "error", "-i", temp / "a.gif", "-frames:v", "1", "-f",
                   "rawvideo", "-pix_fmt", "gray", "-"});
    ASSERT_EQ(pixels.output.size(), 64U * 16U) << pixels.error;
    const auto grey = [&](int x, int y) {
        return int(std::uint8_t(pixels.output[std::size_t(64 * y + x)]));
    };
    EXPECT_EQ(grey(1, 1), 220);
    EXPECT_EQ(grey(30, 14), 40);
    EXPECT_EQ(grey(15, 8), 255);
    EXPECT_EQ(grey(32 + 7, 9), std::lround(frame.intensity(9, 7) * 255));
}

TEST(VideoSink, TheLastFrameStandsAsLongAsTheOthers) {
    const TempFolder temp;
    for (const std::string name : {"a.mp4", "a.mkv", "a.avi", "a.gif"}) {
        VideoSink sink{{.path = temp / name, .fps = 20}};
        for (int n = 0; n < 4; ++n) sink.write(test::ramp_frame(64, 48, n, from_us(50'000 * n)));
        sink.close();
        EXPECT_NEAR(std::stod(probe(temp / name, {"-show_entries", "format=duration"})), 0.2, 1e-6)
            << name;
    }
}

TEST(VideoSink, PadsOddSizesAndPutsSigmaBeside) {
    const TempFolder temp;
    VideoSink sink{{.path = temp / "a.mp4", .uncertainty = Uncertainty::side}};
    for (int n = 0; n < 3; ++n) sink.write(test::ramp_frame(33, 17, n, from_us(40'000 * n)));
    sink.close();
    EXPECT_EQ(probe(temp / "a.mp4", {"-show_entries", "stream=width,height"}), "66,18\n");
}

TEST(VideoSink, CanWriteSigmaAsASecondFile) {
    const TempFolder temp;
    VideoSink sink{{.path = temp / "a.mp4", .uncertainty = Uncertainty::separate}};
    for (int n = 0; n < 3; ++n) sink.write(test::ramp_frame(32, 16, n, from_us(40'000 * n)));
    sink.close();
    EXPECT_EQ(packet_times(temp / "a.sigma.mp4"), packet_times(temp / "a.mp4"));
}

TEST(VideoSink, ShowsTheGreysItWasGiven) {
    const TempFolder temp;
    Frame frame = test::ramp_frame(64, 64, 0, from_us(0));
    for (float& v : frame.intensity.values()) v = 0.6f;
    for (float& v : frame.sigma.values()) v = 0.12f;
    VideoSink sink{{.path = temp / "a.mp4",
                    .uncertainty = Uncertainty::separate,
                    .sigma_white = 0.2f,
                    .crf = 0}};
    sink.write(frame);
    sink.close();
    for (const std::string video : {"a.mp4", "a.sigma.mp4"}) {
        const std::string grey = temp / (video + ".gray");
        const test::Result result = test::run({"ffmpeg", "-v", "error", "-i", temp / video, "-f",
                                               "rawvideo", "-pix_fmt", "gray", grey});
        ASSERT_EQ(result.exit_code, 0) << result.error;
        const std::string pixels = test::read_text(grey);
        ASSERT_EQ(pixels.size(), 64U * 64U);
        for (const char c : pixels) EXPECT_NEAR(int(std::uint8_t(c)), 153, 1) << video;
    }
}

TEST(VideoSink, ShowsTheColoursItWasGiven) {
    const TempFolder temp;
    Frame frame = test::ramp_frame(64, 64, 0, from_us(0));
    const std::array<int, 3> bgr{40, 120, 200};
    for (std::size_t c = 0; c < 3; ++c) {
        frame.colour[c] = Array2<float>{64, 64};
        for (float& v : frame.colour[c].values()) v = float(bgr[c]) / 255;
    }
    for (const std::string name : {"a.mp4", "a.mkv", "a.avi"}) {
        VideoSink sink{{.path = temp / name, .crf = 0}};
        sink.write(frame);
        sink.close();
    }
    StreamSink sink{{.path = temp / "a.y4m"}};
    sink.write(frame);
    sink.close();
    for (const std::string name : {"a.mp4", "a.mkv", "a.avi", "a.y4m"}) {
        const test::Result read =
            test::run({"ffmpeg", "-v", "error", "-i", temp / name, "-frames:v", "1", "-f",
                       "rawvideo", "-pix_fmt", "bgr24", "-"});
        ASSERT_EQ(read.output.size(), 3U * 64 * 64) << read.error;
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(int(std::uint8_t(read.output[c])), bgr[c], 3) << name << ", channel " << c;
    }
}

TEST(VideoSink, TimeThatGoesBackGoesOnInTheVideo) {
    const TempFolder temp;
    VideoSink sink{{.path = temp / "a.mp4", .fps = 100}};
    for (const std::int64_t t : {5'000'000, 5'010'000, 0, 12'345})
        sink.write(test::ramp_frame(32, 32, 0, from_us(t)));
    sink.close();
    EXPECT_EQ(packet_times(temp / "a.mp4"), (std::vector<std::int64_t>{0, 10'000, 20'000, 32'345}));
}

TEST(VideoSink, FramesThatFallOnOneMicrosecondAreNoClockThatWentBack) {
    const TempFolder temp;
    VideoSink sink{{.path = temp / "a.mp4", .fps = 100, .slow = 0.001}};
    for (int n = 0; n < 5; ++n) sink.write(test::ramp_frame(32, 32, 0, from_us(300 * n)));
    sink.close();
    EXPECT_EQ(packet_times(temp / "a.mp4"), (std::vector<std::int64_t>{0, 1, 2, 3, 4}));
}

/// A pause of an hour in MP4; of a minute and two thirds in Motion JPEG, which counts 60,000
/// frames.
TEST(VideoSink, APauseThatAFileCannotHoldIsShortened) {
    const TempFolder temp;
    const auto times = [&](const std::string& name, double fps, std::int64_t pause_us) {
        VideoSink sink{{.path = temp / name, .fps = fps}};
        const std::int64_t step_us = std::llround(1e6 / fps);
        for (const std::int64_t us : {std::int64_t{0}, step_us, pause_us, pause_us + step_us})
            sink.write(test::ramp_frame(32, 32, 0, from_us(us)));
        sink.close();
        return packet_times(temp / name);
    };
    EXPECT_EQ(times("a.mp4", 1, 3'600'000'000),
              (std::vector<std::int64_t>{0, 1'000'000, 2'148'483'646, 2'149'483'646}));
    EXPECT_EQ(times("a.mkv", 1, 3'600'000'000),
              (std::vector<std::int64_t>{0, 1000, 3'600'000, 3'601'000}));
    EXPECT_EQ(times("a.avi", 1000, 100'000'000), (std::vector<std::int64_t>{0, 1, 60'001, 60'002}));
}

/// A scene that stands still: nothing else makes the encoder begin a group of images.
TEST(VideoSink, AKilledProgramLeavesAVideoThatPlays) {
    const TempFolder temp;
    const pid_t child = fork();
    if (child == 0) {
        VideoSink sink{{.path = temp / "a.mp4"}};
        for (int n = 0; n < 200; ++n) sink.write(test::ramp_frame(64, 48, 0, test::odd_time(n)));
        kill(getpid(), SIGKILL);
    }
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status));
    EXPECT_GE(packet_times(temp / "a.mp4").size(), 120U);
}

TEST(VideoSink, WithoutAFrameThereIsNoFile) {
    const TempFolder temp;
    VideoSink sink{{.path = temp / "a.mp4"}};
    sink.close();
    EXPECT_FALSE(std::filesystem::exists(temp / "a.mp4"));
}

TEST(VideoSink, SaysWhatIsWrong) {
    const TempFolder temp;
    EXPECT_THROW((VideoSink{{.path = temp / "a.xyz"}}), Error);
    EXPECT_THROW((VideoSink{{.path = temp / "a.mp4", .crf = 99}}), Error);
    EXPECT_THROW((VideoSink{{.path = temp / "a.mp4", .uncertainty = Uncertainty::alpha}}), Error);
    EXPECT_THROW((VideoSink{{.path = "/nowhere/a.mp4"}}), Error);
    EXPECT_THROW((VideoSink{{.path = temp / "a.mp4", .preset = "quick"}}), Error);
}

TEST(VideoSink, AnEncoderThatCannotWriteSaysSo) {
    const TempFolder temp;
    std::filesystem::create_symlink("/dev/full", temp / "a.mp4");
    EXPECT_THROW(
        {
            VideoSink sink{{.path = temp / "a.mp4"}};
            for (int n = 0; n < 100; ++n)
                sink.write(test::ramp_frame(64, 48, n, test::odd_time(n)));
            sink.close();
        },
        Error);
}

}  // namespace
}  // namespace eventide
