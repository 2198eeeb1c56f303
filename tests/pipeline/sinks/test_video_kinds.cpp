// What each kind of video keeps of the frames and their times.
#include "pipeline/sinks/video/video.h"
#include "src/core/error.h"
#include "tests/pipeline/sinks/frames.h"
#include "tests/pipeline/sinks/probed_video.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace eventide {
namespace {

using test::packet_times;
using test::probe;
using test::TempFolder;

TEST(VideoSink, GifKeepsEveryGreyAndHundredthsOfASecond) {
    const TempFolder temp;
    const Frame frame = test::ramp_frame(33, 17, 3, from_us(0));
    VideoSink sink{{.path = temp / "a.gif", .fps = 50}};
    for (const std::int64_t us : {0, 20'000, 44'000, 61'000}) {
        Frame next = test::ramp_frame(33, 17, 3, from_us(us));
        sink.write(next);
    }
    sink.close();
    EXPECT_EQ(packet_times(temp / "a.gif"), (std::vector<std::int64_t>{0, 2, 4, 6}));
    const test::Result pixels =
        test::run({"ffmpeg", "-v", "error", "-i", temp / "a.gif", "-frames:v", "1", "-f",
                   "rawvideo", "-pix_fmt", "gray", "-"});
    ASSERT_EQ(pixels.output.size(), 33U * 17U) << pixels.error;
    for (std::size_t i = 0; i < pixels.output.size(); ++i)
        EXPECT_EQ(int(std::uint8_t(pixels.output[i])),
                  std::lround(frame.intensity.values()[i] * 255));
}

TEST(VideoSink, AFrameOfAGifStandsAsLongAsPlayersShowItWhenTheNextComesSoon) {
    const TempFolder temp;
    VideoSink sink{{.path = temp / "a.gif", .fps = 30}};
    // As event windows end with --fps frame; players would show the first for 100 ms.
    for (const std::int64_t us : {0, 11'000, 24'000, 90'000, 131'000})
        sink.write(test::ramp_frame(33, 17, 3, from_us(us)));
    sink.close();
    EXPECT_EQ(packet_times(temp / "a.gif"), (std::vector<std::int64_t>{0, 2, 4, 9, 13}));
}

TEST(VideoSink, GifRefusesWhatPlayersWouldNotShow) {
    const TempFolder temp;
    EXPECT_THROW((VideoSink{{.path = temp / "a.gif", .fps = 60}}), Error);
    EXPECT_THROW((VideoSink{{.path = temp / "a.gif", .uncertainty = Uncertainty::overlay}}), Error);
    EXPECT_THROW((VideoSink{{.path = temp / "a.mov"}}), Error);
    EXPECT_FALSE(std::filesystem::exists(temp / "a.gif"));
}

TEST(VideoSink, MotionJpegHasOneRate) {
    const TempFolder temp;
    VideoSink sink{{.path = temp / "a.avi", .uncertainty = Uncertainty::overlay, .fps = 25}};
    for (int n = 0; n < 10; ++n) sink.write(test::ramp_frame(33, 17, n, from_us(40'000 * n)));
    sink.close();
    EXPECT_EQ(probe(temp / "a.avi", {"-count_frames", "-show_entries",
                                     "stream=codec_name,width,height,r_frame_rate,nb_read_frames"}),
              "mjpeg,34,18,25/1,10\n");
}

TEST(VideoSink, MatroskaKeepsMilliseconds) {
    const TempFolder temp;
    VideoSink sink{{.path = temp / "a.mkv", .fps = 300}};
    for (int n = 0; n < 40; ++n) sink.write(test::ramp_frame(64, 48, n, test::odd_time(n)));
    sink.close();
    const auto times = packet_times(temp / "a.mkv");
    ASSERT_EQ(times.size(), 40U);
    for (int n = 0; n < 40; ++n)
        EXPECT_NEAR(double(times[std::size_t(n)]),
                    double((test::odd_time(n) - test::odd_time(0)).count()) / 1000, 0.51);
}

TEST(VideoSink, AFasterRateThanMatroskasClockLosesNoFrame) {
    const TempFolder temp;
    VideoSink sink{{.path = temp / "a.mkv", .fps = 3000}};
    for (int n = 0; n < 60; ++n) sink.write(test::ramp_frame(64, 48, n, from_us(333 * n)));
    sink.close();
    EXPECT_EQ(packet_times(temp / "a.mkv").size(), 60U);
}

}  // namespace
}  // namespace eventide
